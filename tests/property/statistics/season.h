// Sessions of robots in one segment whose features change with the season: every query draws its
// inliers, searches with the strategy in force, and is localized or not.
#pragma once

#include <string>
#include <vector>

#include "mapstore/base/random.h"
#include "mapstore/statistics/probabilities.h"
#include "mapstore/statistics/selector.h"

namespace maploc::testing {

struct Season {
  double point_inlier_ratio = 0.6;
  double line_inlier_ratio = 0.3;
};

struct Robots {
  int queries = 40;  // a session
  int points = 120;  // matches of a query, give or take a quarter
  int usable_lines = 120;
  int max_iterations = 100;    // of a strategy
  bool fall_back = false;      // to the others in the decision's order
  double session_noise = 0.1;  // of a session's ratios, relative
  double query_noise = 0.2;    // of a query's
};

// Session `number` (its start, and "s<number>" with leading zeros) under the decision in force.
SegmentSessionRow RunSession(int number, const Season& season, const Robots& robots,
                             const StrategyDecision& decision, Random& random);

}  // namespace maploc::testing
