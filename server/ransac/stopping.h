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

// Iterations after which a draw of probability `draw_probability` times `yield` has happened with
// `confidence`. `yield` is the share of all-inlier samples that lead to the pose. At least 1;
// clamped to `max_iterations`.
int RequiredIterations(double draw_probability, double yield, double confidence,
                       int max_iterations);

}  // namespace maploc
