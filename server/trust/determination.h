// Do the inliers determine the pose? Unlikely to be chance is not enough: fifteen true matches on
// one patch of wall leave the camera free to turn around the patch, and the map's own errors, or
// one wrong match at another depth, then choose the pose.
#pragma once

#include <numbers>

#include "server/refinement/refine.h"

namespace maploc {

// The pose's standard deviations, the position's as a share of the inliers' median depth.
struct PoseSpread {
  double rotation_rad = 0.0;
  double position_share = 0.0;
};

// What is asked of a pose that is told; nearer than this, two poses may be one and its noise.
inline constexpr PoseSpread kMaxSpread = {.rotation_rad = 5.0 * std::numbers::pi / 180.0,
                                          .position_share = 0.1};

// Median depth of the inliers under the pose, in the map's unit: of a line, that of the middle of
// its part in front of the camera. 0 without inliers. Thread-safe.
double MedianInlierDepth(const PoseProblem& problem, const RefinedPose& pose);

// True when the pose stays within `limit` by inliers that are worth no more than what is known of
// them, WHICHEVER one of them is left out:
// * an inlier is off by 1.5 times what the residuals and the map's own errors say
//   (RefinedPose::feature_sigma_px), but by no more than anything within the threshold: a disc's
//   uniform distribution has a standard deviation of half of its radius in each coordinate;
// * landmarks of one place are triangulated from the same photos and err together, so that errors
//   do not average: all inliers weigh as much as one would in their places (information / n);
// * gravity counts with its stated sigma.
// One inlier among the inliers is expected to be wrong: where a pose has a direction to give way,
// it gives way to the first accident. O(inliers); deterministic; thread-safe.
bool IsDetermined(const PoseProblem& problem, const RefinedPose& pose,
                  double max_reprojection_error_px, const PoseSpread& limit);

}  // namespace maploc
