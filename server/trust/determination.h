// Do the inliers determine the pose? A low probability of chance is not enough: with fifteen true
// matches on one patch of wall the camera can still rotate around the patch. The map's own errors,
// or one wrong match at another depth, then decide the pose.
#pragma once

#include <numbers>

#include "server/refinement/refine.h"

namespace maploc {

// The pose's standard deviations, the position's as a share of the inliers' median depth.
struct PoseSpread {
  double rotation_rad = 0.0;
  double position_share = 0.0;
};

// Largest spread of a pose that is reported. Two poses that are nearer than this may be one pose
// and its noise.
inline constexpr PoseSpread kMaxSpread = {.rotation_rad = 5.0 * std::numbers::pi / 180.0,
                                          .position_share = 0.1};

// Median depth of the inliers under the pose, in the map's unit: of a line, that of the middle of
// its part in front of the camera. 0 without inliers. Thread-safe.
double MedianInlierDepth(const PoseProblem& problem, const RefinedPose& pose);

// Is the pose still determined to within `limit` when any single inlier is left out? Weights:
// * The standard deviation of an inlier is 1.5 times what the residuals and the map's own errors
//   give (RefinedPose::feature_sigma_px). It is at most half of the threshold: the standard
//   deviation, in each coordinate, of a uniform distribution over the threshold's disc.
// * Landmarks of one place are triangulated from the same photos and have common errors, which do
//   not average out: all inliers together weigh as much as one would in their places
//   (information / n).
// * Gravity counts with its stated sigma.
// One of the inliers is expected to be wrong: a pose that is weakly determined in one direction is
// moved in that direction by the first wrong one. O(inliers); deterministic; thread-safe.
bool IsDetermined(const PoseProblem& problem, const RefinedPose& pose,
                  double max_reprojection_error_px, const PoseSpread& limit);

}  // namespace maploc
