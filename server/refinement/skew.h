// The matrix of a cross product.
#pragma once

#include <Eigen/Core>

namespace maploc {

// Skew(v) w = v x w.
inline Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace maploc
