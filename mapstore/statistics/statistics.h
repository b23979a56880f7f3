// From observations to rows, from rows to statistics, from statistics to a strategy: pure functions
// (README.md).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "mapstore/model/session.h"
#include "mapstore/statistics/change.h"
#include "mapstore/statistics/statistics_options.h"

namespace maploc {

// One session's observations, by segment, ascending. Order of the observations does not matter.
// OUT_OF_MAP ones (segment -1) make no row. Medians of an even count are the mean of the middle
// two. REQUIRES: no sequence twice.
std::vector<SegmentSessionRow> FoldObservations(const Session& session,
                                                std::span<const Observation> observations);

// All that a fold has to remember of the rows so far.
struct StatisticsSums {
  // Plain counts.
  std::int64_t sessions = 0;
  std::int64_t queries = 0;
  std::int64_t localized = 0;
  // All else is weighted by age.
  std::array<SessionShares, kChangeKinds.size()> shares;  // by kind
  std::array<Scatter, kChangeKinds.size()> scatters;  // by kind; a change leaves them as they are
  Proportion usable_lines;
  Proportion vertical_lines;
  // Sums of (weight x localized queries x a session's median); the means are these by the
  // localized queries by weight.
  double point_medians = 0.0;
  double usable_line_medians = 0.0;
  double vertical_line_medians = 0.0;
  bool operator==(const StatisticsSums&) const = default;
};

// One session after the other, oldest first; the sum so far loses weight before each. Statistics
// of the first n rows are those of n calls of Add, so that a replay costs no more than one pass.
class StatisticsFold {
 public:
  // `sums`: of the rows before, folded with the same options.
  explicit StatisticsFold(const StatisticsOptions& options, const StatisticsSums& sums = {});

  // REQUIRES: rows come in the order (session_start_unix_ns, session).
  void Add(const SegmentSessionRow& row);
  const StatisticsSums& sums() const { return sums_; }
  SegmentStatistics Value() const;

 private:
  void Age();
  // Whether `row` disagrees with the sum so far.
  bool IsChange(const SegmentSessionRow& row) const;
  void AddScatter(const SegmentSessionRow& row);
  void Discount(double factor);

  StatisticsOptions options_;
  double decay_;  // of one rank
  StatisticsSums sums_;
};

// REQUIRES: rows in the order (session_start_unix_ns, session). The age of a row is its rank from
// the end.
SegmentStatistics Aggregate(std::span<const SegmentSessionRow> rows,
                            const StatisticsOptions& options = {});

}  // namespace maploc
