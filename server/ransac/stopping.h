// When is it enough? Each strategy has its own probability that one draw is all inliers; the square
// of the inlier ratio is 2P's alone and overestimates mixed's.
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

// Probability that one draw of the strategy is all inliers (design.md section 6); 0 where it cannot
// be drawn.
double DrawProbability(Strategy strategy, const InlierCounts& counts);

// Evaluated hypotheses that lead to the pose, over what DrawProbability says of draws. More than
// one, because an all-inlier draw has a valid solution and most others are drawn again uncounted;
// gates, noise and gravity take some back. Measured 1.2 to 2.6 for the 2-entity strategies and 1.07
// to 1.4 for P3P (README.md); the least is used.
double Yield(Strategy strategy);

// Iterations after which a draw of probability `draw_probability` times `yield` has happened with
// `confidence`. At least 1; clamped to `max_iterations`.
int RequiredIterations(double draw_probability, double yield, double confidence,
                       int max_iterations);

// Iterations after which a strategy that was expected to succeed with `predicted_success` an
// iteration is given up for the next: four times what it needs to be all but sure of success, and
// no fewer than 200. A query without a match of the kind that its segment's strategy draws would
// else pay for `max_iterations`. No prediction (0): `max_iterations`; so for mixed, which draws of
// every kind: what it does not find soon is hard to find for the others too.
int Patience(Strategy strategy, double predicted_success, int max_iterations);

}  // namespace maploc
