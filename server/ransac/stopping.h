// When to stop sampling. Each strategy has its own probability that one draw is all inliers. The
// square of the inlier ratio holds for 2P only; for mixed it is too high.
#pragma once

#include "mapstore/model/strategy.h"

namespace maploc {

// What the best pose so far says about the matches.
struct InlierCounts {
  int points = 0;
  int point_inliers = 0;
  int usable_lines = 0;
  int usable_line_inliers = 0;
  int vertical_lines = 0;  // 0 where they are not drawn
  int vertical_line_inliers = 0;
};

// Probability that one draw of the strategy is all inliers (the paper's section IV); 0 where it
// cannot be drawn.
double DrawProbability(Strategy strategy, const InlierCounts& counts);

// Ratio of the share of evaluated hypotheses that lead to the pose to DrawProbability. It is above
// 1 because an all-inlier draw has a valid solution, while most other draws have none and are
// repeated without being counted; gates, noise and gravity reduce it. Measured 1.2 to 2.6 for the
// 2-entity strategies and 1.07 to 1.33 for P3P (MEASUREMENTS.md); 1.2 and 1 are used.
double Yield(Strategy strategy);

// Iterations after which a draw of probability `draw_probability` times `yield` has occurred with
// probability `confidence`. At least 1; at most `max_iterations`.
int RequiredIterations(double draw_probability, double yield, double confidence,
                       int max_iterations);

// Iterations after which the next strategy is tried, when a success of `predicted_success` per
// iteration was expected: four times the number that succeeds almost surely, and at least 200.
// Without this limit, a query without matches of the kind that its segment's strategy draws would
// cost `max_iterations`. `max_iterations` without a prediction (0), and for mixed: it draws every
// kind, so what it does not find soon is also hard for the others.
int Patience(Strategy strategy, double predicted_success, int max_iterations);

}  // namespace maploc
