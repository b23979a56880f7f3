#include "server/trust/gravity_check.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "mapstore/geometry/gravity.h"

namespace maploc {
namespace {

constexpr double kChiSquare2AtOneInTenThousand = 18.42068;
constexpr std::size_t kEnoughInliers = 200;
constexpr double kLeastGravitySigmaRad = 0.1 * std::numbers::pi / 180.0;

// The turn about the map's x and y axes that takes the map's gravity to the measured one.
Eigen::Vector2d Tilt(const PoseProblem& problem, const Rigid3& camera_from_map) {
  const Eigen::Vector3d measured_in_map =
      camera_from_map.rotation.conjugate() * problem.gravity_in_camera;
  const double angle = AngleBetween(kGravityInMap, measured_in_map);
  const Eigen::Vector2d axis = kGravityInMap.cross(measured_in_map).head<2>();
  // The same direction, or the opposite one, which any horizontal axis turns back.
  if (!(axis.norm() > 0)) return {angle, 0.0};
  return angle * axis.normalized();
}

template <typename Feature>
std::vector<Feature> EveryKth(std::size_t step, const std::vector<Feature>& features) {
  std::vector<Feature> kept;
  for (std::size_t i = 0; i < features.size(); i += step) kept.push_back(features[i]);
  return kept;
}

// Where there are hundreds of inliers, a part of the matches tells tilt far better than any
// accelerometer.
PoseProblem EnoughOf(const PoseProblem& problem, const RefinedPose& pose) {
  const std::size_t step = (pose.InlierCount() + kEnoughInliers - 1) / kEnoughInliers;
  if (step <= 1) return problem;
  PoseProblem part = problem;
  part.points = EveryKth(step, problem.points);
  part.lines = EveryKth(step, problem.lines);
  return part;
}

}  // namespace

GravityCheck CompareGravity(const PoseProblem& problem, const RefinedPose& matches_alone) {
  const Eigen::Vector2d tilt = Tilt(problem, matches_alone.camera_from_map);
  const double sigma = std::max(problem.gravity_sigma_rad, kLeastGravitySigmaRad);
  const Eigen::Matrix2d spread =
      matches_alone.covariance.block<2, 2>(3, 3) + sigma * sigma * Eigen::Matrix2d::Identity();
  const double distance2 = tilt.dot(spread.ldlt().solve(tilt));
  return {tilt.norm(), tilt, distance2 <= kChiSquare2AtOneInTenThousand};
}

GravityCheck CheckGravity(const PoseProblem& problem, const RefinedPose& pose,
                          const RefineOptions& options) {
  if (!problem.has_gravity) return {};
  RefineOptions free = options;
  free.mode = Refinement::k6Dof;
  const RefinedPose matches_alone = RefinePose(EnoughOf(problem, pose), pose.camera_from_map, free);
  if (!matches_alone.converged) return {};
  return CompareGravity(problem, matches_alone);
}

}  // namespace maploc
