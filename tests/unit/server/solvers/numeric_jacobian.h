// Derivatives of an error by the pose, by differences.
#pragma once

#include <Eigen/Geometry>

#include "server/solvers/reprojection.h"

namespace maploc::testing {

// `by`: (w, d) of reprojection.h.
inline PoseMatrix Perturbed(const PoseMatrix& pose, const Eigen::Matrix<double, 6, 1>& by) {
  PoseMatrix moved = pose;
  const Eigen::Vector3d w = by.head<3>();
  if (w.norm() > 0) {
    moved.rotation = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() * pose.rotation;
  }
  moved.translation += by.tail<3>();
  return moved;
}

// Central differences of `error` at `pose`.
template <typename Error>
Jacobian26 NumericJacobian(const PoseMatrix& pose, const Error& error) {
  Jacobian26 jacobian;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Matrix<double, 6, 1> step = kStep * Eigen::Matrix<double, 6, 1>::Unit(i);
    jacobian.col(i) = (error(Perturbed(pose, step)) - error(Perturbed(pose, -step))) / (2 * kStep);
  }
  return jacobian;
}

}  // namespace maploc::testing
