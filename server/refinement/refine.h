// From a consensus to the pose: nonlinear least squares over inlier points and lines (Ceres), and
// its covariance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/matches.h"
#include "mapstore/model/strategy.h"

namespace maploc {

// Cauchy's loss at this many sigmas: a true inlier hardly feels it, a wrong match inside of the
// threshold does.
inline constexpr double kLossScaleSigmas = 2.5;

struct RefineOptions {
  Refinement mode = Refinement::kAuto;
  double pixel_sigma = 1.0;  // noise of a keypoint and of a line's end point, in pixels, before the
                             // residuals have been seen
  double max_reprojection_error_px = 4.0;  // inliers are gathered anew under each refined pose
};

struct RefinedPose {
  bool converged = false;
  Rigid3 camera_from_map;
  // Of map_from_camera: order and frame as PoseCovariance says. Holds the keypoints' noise as the
  // inliers' residuals show it, and what the map's landmarks err together
  // (PoseProblem::shared_error_rad), which no number of inliers averages out. For a fixed gravity
  // its own uncertainty is propagated, so that roll and pitch are never zero.
  PoseCovariance covariance = PoseCovariance::Zero();
  std::vector<std::uint8_t> point_inliers;  // under the final pose
  std::vector<std::uint8_t> line_inliers;
  double inlier_rms_px = 0.0;     // root mean square of the inliers' errors, of one coordinate
  double feature_sigma_px = 0.0;  // of one coordinate: noise and shared error

  // Points and lines.
  std::size_t InlierCount() const;
};

// Deterministic; thread-safe. Without gravity the mode is 6Dof.
RefinedPose RefinePose(const PoseProblem& problem, const Rigid3& camera_from_map,
                       const RefineOptions& options);

}  // namespace maploc
