#include "mapstore/geometry/gravity.h"

#include <cmath>

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

}  // namespace maploc
