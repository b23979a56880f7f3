// How probably one draw of each strategy is all inliers, and one iteration succeeds (the paper's
// section IV; README.md, "Draw and iteration"; server/ransac/sampler.h draws).
#pragma once

#include "mapstore/model/strategy.h"

namespace maploc {

// Matches of a query.
struct MatchCounts {
  double points = 0.0;          // p
  double usable_lines = 0.0;    // l
  double vertical_lines = 0.0;  // lv
};

// Shares of them that are right.
struct InlierRates {
  double points = 0.0;          // lambda
  double usable_lines = 0.0;    // gamma
  double vertical_lines = 0.0;  // gamma_v
};

// One number a strategy that the selector knows.
struct StrategyValues {
  double p1p1l = 0.0;
  double p2p = 0.0;
  double mixed = 0.0;

  // REQUIRES: 1P1L, 2P or mixed.
  double Of(Strategy strategy) const {
    return strategy == Strategy::k1P1L ? p1p1l : strategy == Strategy::k2P ? p2p : mixed;
  }
};

// The model's rule (strategy.h) for counts that are means over queries, rounded.
bool DrawsVerticalLines(Strategy strategy, const MatchCounts& counts);

// Probability that one draw is all inliers, in [0, 1]; 0 where it cannot be drawn:
//   1P1L   lambda (gamma l + v) / (l + nv)                   p >= 1, l + nv >= 1
//   2P     lambda (lambda p - 1) / (p - 1)                   p >= 2
//   mixed  lambda (lambda p - 1 + gamma l + v) / (p - 1 + l + nv)   p >= 1, p + l + nv >= 2
// v = nv = 0 where vertical lines take no part. Else a vertical line asks for a second one (1P2V):
// nv = lv - 1 (the sampler draws again when it draws the same line twice, one time in lv) and
// v = nv gamma_v (gamma_v lv - 1) / (lv - 1). Without vertical lines: the paper's formulas.
StrategyValues DrawProbabilities(const MatchCounts& counts, const InlierRates& rates);

// What becomes of a draw, by what it draws: the sampler's gates refuse degenerate samples, and a
// sample without a valid solution is drawn again and is no iteration.
struct SampleYield {
  double good = 1.0;  // share of all-inlier draws that are evaluated and lead to the pose
  double bad = 1.0;   // share of the other draws that are evaluated
  bool operator==(const SampleYield&) const = default;
};

// Measured with the sampler in the estimator's test scenes (MEASUREMENTS.md).
struct SampleYields {
  SampleYield two_points = {0.75, 0.4};
  SampleYield point_and_line = {0.75, 0.45};
  SampleYield point_and_verticals = {0.8, 0.67};
  bool operator==(const SampleYields&) const = default;
};

// Every draw is evaluated, and every good one leads to the pose.
inline constexpr SampleYields NoGates() { return {{1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}; }

// Probability that one iteration (an evaluated draw) leads to the pose: of the draws that are
// evaluated, those which do. With yields of 1 (NoGates) it is DrawProbabilities.
StrategyValues IterationProbabilities(const MatchCounts& counts, const InlierRates& rates,
                                      const SampleYields& yields);

}  // namespace maploc
