// How a segment's strategy is selected. Stored with the rows and pins that it was applied to, so
// that any process can derive a decision anew.
#pragma once

#include <cstdint>

#include "mapstore/statistics/probabilities.h"
#include "mapstore/statistics/statistics.h"

namespace maploc {

// How the selector compares strategies.
enum class StrategyCriterion {
  kExpectedTime = 1,  // least time to success
  kPaper = 2,         // gamma >= lambda: 1P1L, else 2P
};

struct SelectorOptions {
  StatisticsOptions statistics;
  StrategyCriterion criterion = StrategyCriterion::kExpectedTime;
  // Evidence before the strategy leaves "mixed": localized queries, weighted by age.
  std::int64_t min_localized_queries = 10;
  double prior_matches = 10.0;      // weak Beta prior: this many matches ...
  double prior_inlier_ratio = 0.3;  // ... at this rate
  // Another strategy takes over when it beats the current one's expected time by this share (the
  // paper's rule: when the one rate exceeds the other by it).
  double hysteresis = 0.15;
  std::int64_t max_iterations = 10000;  // of a query, then it fails; positive
  SampleYields yields;
  // Nanoseconds of one iteration (draw, solve, score) of each strategy; relative figures suffice.
  // Measured (MEASUREMENTS.md): equal except for mixed, whose branches are predicted less well.
  double cost_1p1l = 1.0;
  double cost_2p = 1.0;
  double cost_mixed = 1.04;
  bool operator==(const SelectorOptions&) const = default;
};

}  // namespace maploc
