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

// One session after the other, oldest first; the sum so far loses weight before each. Statistics
// of the first n rows are those of n calls of Add, so that a replay costs no more than one pass.
class StatisticsFold {
 public:
  explicit StatisticsFold(const StatisticsOptions& options);

  // REQUIRES: rows come in the order (session_start_unix_ns, session).
  void Add(const SegmentSessionRow& row);
  SegmentStatistics Value() const;

 private:
  // Whether `row` disagrees with the sum so far.
  bool IsChange(const SegmentSessionRow& row) const;
  void Discount(double factor);

  StatisticsOptions options_;
  double decay_;  // of one rank
  // Plain counts.
  std::int64_t sessions_ = 0;
  std::int64_t queries_ = 0;
  std::int64_t localized_ = 0;
  // All else is weighted by age.
  std::array<Proportion, kChangeKinds.size()> shares_;  // by kind
  Proportion usable_lines_;
  Proportion vertical_lines_;
  // Sums of (weight x localized queries x a session's median); the means are these by the
  // localized queries by weight.
  double point_medians_ = 0.0;
  double usable_line_medians_ = 0.0;
  double vertical_line_medians_ = 0.0;
};

// REQUIRES: rows in the order (session_start_unix_ns, session). The age of a row is its rank from
// the end.
SegmentStatistics Aggregate(std::span<const SegmentSessionRow> rows,
                            const StatisticsOptions& options = {});

}  // namespace maploc
