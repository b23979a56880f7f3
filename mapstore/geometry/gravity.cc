#include "mapstore/geometry/gravity.h"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace maploc {

Eigen::Quaterniond CameraFromAligned(const Eigen::Vector3d& gravity_in_camera) {
  // Quaternion of the shortest rotation from a = (0,0,-1) to g: (1 + a.g, a x g), normalized.
  const Eigen::Vector3d& g = gravity_in_camera;
  const double horizontal2 = g.head<2>().squaredNorm();
  if (horizontal2 == 0.0 && g.z() > 0) return Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
  // 1 - g.z cancels near +z; there it is horizontal2 / (1 + g.z).
  const double w = g.z() > 0 ? horizontal2 / (1.0 + g.z()) : 1.0 - g.z();
  return Eigen::Quaterniond(w, g.y(), -g.x(), 0.0).normalized();
}

Eigen::Vector3d GravityInCamera(const Eigen::Quaterniond& camera_from_map) {
  return camera_from_map * kGravityInMap;
}

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

GravityEstimate EstimateGravityFromPoses(std::span<const Rigid3> camera_from_source) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum_down = Eigen::Vector3d::Zero();
  for (const Rigid3& pose : camera_from_source) {
    const Eigen::Matrix3d axes_in_source = pose.rotation.toRotationMatrix().transpose();
    scatter += axes_in_source.col(0) * axes_in_source.col(0).transpose();
    sum_down += axes_in_source.col(1);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const double count = static_cast<double>(camera_from_source.size());
  // The middle eigenvalue says how well the x axes span a plane; below a degree of spread they do
  // not.
  constexpr double kMinimalSpread = 3e-4;
  GravityEstimate estimate;
  if (camera_from_source.size() < 2 || solver.eigenvalues()(1) < kMinimalSpread * count) {
    if (!camera_from_source.empty() && sum_down.norm() > 0) {
      estimate.gravity_in_source = sum_down.normalized();
    }
    estimate.spread_rad = std::numbers::pi / 2;
    return estimate;
  }
  const Eigen::Vector3d down = solver.eigenvectors().col(0);
  estimate.gravity_in_source = down.dot(sum_down) < 0 ? Eigen::Vector3d(-down) : down;
  estimate.spread_rad = std::asin(std::sqrt(std::clamp(solver.eigenvalues()(0) / count, 0.0, 1.0)));
  return estimate;
}

}  // namespace maploc
