// From observations to rows, from rows to statistics, from statistics to a strategy: pure functions
// (design.md section 6).
#pragma once

#include <span>
#include <vector>

#include "mapstore/model/session.h"

namespace maploc {

struct StatisticsOptions {
  double half_life_sessions = 20.0;  // a session this much older counts half; positive
  // A session whose own inlier ratio (of points, or of lines), or whose own share of localized
  // queries, lies outside the 99% interval that the older sessions predict for it tells of a
  // change: the older ones keep this share of their weight. In [0, 1]; 1 turns it off.
  double change_discount = 0.05;
  // How many independent matches a localized query is worth, at most, and how many independent
  // queries a session. The matches of one view stand and fall together, and so do the views of one
  // session (one light, one season); taken as independent, they would make every session a change
  // and every ratio certain. Positive.
  double independent_matches_per_query = 10.0;
  double independent_queries_per_session = 20.0;
  bool operator==(const StatisticsOptions&) const = default;
};

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
  double IndependentQueries(std::int64_t queries) const;
  // Of a session's localized queries.
  double IndependentMatches(const SegmentSessionRow& row, std::int64_t matches) const;
  void AddIndependent(const SegmentSessionRow& row);
  // Whether `row` disagrees with the sum so far.
  bool IsChange(const SegmentSessionRow& row) const;
  void Discount(double factor);

  StatisticsOptions options_;
  double decay_;  // of one rank
  SegmentStatistics sum_;
  // Weighted, for the test for a change.
  double independent_lines_ = 0.0;  // usable and vertical together
  double independent_queries_ = 0.0;
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
