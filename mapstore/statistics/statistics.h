// From observations to rows, from rows to statistics, from statistics to a strategy: pure functions
// (design.md section 6).
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
  SegmentStatistics sum_;
  std::array<Proportion, kChangeKinds.size()> shares_;  // weighted, for the test for a change
  // Sums of (weight x localized queries x a session's median); the means are these by
  // sum_.weighted_localized.
  double point_medians_ = 0.0;
  double usable_line_medians_ = 0.0;
  double vertical_line_medians_ = 0.0;
};

// REQUIRES: rows in the order (session_start_unix_ns, session). The age of a row is its rank from
// the end.
SegmentStatistics Aggregate(std::span<const SegmentSessionRow> rows,
                            const StatisticsOptions& options = {});

}  // namespace maploc
