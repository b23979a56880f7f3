// The upright kernels for one sample: rays in the camera, gravity a unit vector in the camera.
#pragma once

#include <algorithm>
#include <cmath>

#include "mapstore/geometry/gravity.h"
#include "server/solvers/aligned.h"
#include "server/solvers/up1p1l.h"
#include "server/solvers/up2p.h"
#include "server/solvers/yaw_equation.h"

namespace maploc::testing {

// `kernel` is called with a function that turns a vector of the camera into the aligned frame and
// with room for two poses, and returns how many it wrote.
template <typename Kernel>
int SolveWithGravity(const Eigen::Vector3d& gravity_in_camera, Rigid3 camera_from_map[2],
                     const Kernel& kernel) {
  const Eigen::Quaterniond camera_from_aligned = CameraFromAligned(gravity_in_camera);
  const Eigen::Matrix3d turn = camera_from_aligned.toRotationMatrix();
  const auto align = [&](const Eigen::Vector3d& in_camera) -> Eigen::Vector3d {
    return turn.transpose() * in_camera;
  };
  AlignedPose aligned[2];
  const int count = kernel(align, aligned);
  for (int i = 0; i < count; ++i) {
    const Eigen::Matrix3d rotation = turn * RotationMatrix(aligned[i].yaw);
    camera_from_map[i] = {Eigen::Quaterniond(rotation).normalized(),
                          camera_from_aligned * aligned[i].translation};
  }
  return count;
}

inline int SolveUp2p(const Eigen::Vector3d& gravity_in_camera, const Eigen::Vector3d& ray1,
                     const Eigen::Vector3d& point1, const Eigen::Vector3d& ray2,
                     const Eigen::Vector3d& point2, Rigid3 camera_from_map[2]) {
  return SolveWithGravity(gravity_in_camera, camera_from_map,
                          [&](const auto& align, AlignedPose* out) {
                            return maploc::SolveUp2p(align(ray1), point1, align(ray2), point2, out);
                          });
}

inline int SolveUp1p1l(const Eigen::Vector3d& gravity_in_camera, const Eigen::Vector3d& ray,
                       const Eigen::Vector3d& point, const Eigen::Vector3d& plane_normal,
                       const Eigen::Vector3d& line_point, const Eigen::Vector3d& line_direction,
                       Rigid3 camera_from_map[2]) {
  return SolveWithGravity(gravity_in_camera, camera_from_map,
                          [&](const auto& align, AlignedPose* out) {
                            return maploc::SolveUp1p1l(align(ray), point, align(plane_normal),
                                                       line_point, line_direction, out);
                          });
}

// w in [0, 1] of yaw_equation.h, by which IsYawConditioned judges a sample: 0 is degenerate, 1 is
// best. 0 for a zero n or D.
inline double YawConditioning(const Eigen::Vector3d& n, const Eigen::Vector3d& d) {
  const double scale2 = n.squaredNorm() * d.squaredNorm();
  const double discriminant = YawDiscriminant(MakeYawEquation(n, d));
  return scale2 > 0 ? std::sqrt(std::max(discriminant, 0.0) / scale2) : 0.0;
}

inline double Up2pConditioning(const Eigen::Vector3d& ray1, const Eigen::Vector3d& point1,
                               const Eigen::Vector3d& ray2, const Eigen::Vector3d& point2) {
  return YawConditioning(ray1.cross(ray2), point2 - point1);
}

}  // namespace maploc::testing
