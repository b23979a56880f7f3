// The gravity-aligned frame: the camera turned so that gravity is (0, 0, -1), as in the map. What
// is left of the pose is a yaw and a translation: aligned_from_map = [Rz(yaw) | t].
//
// The kernels (up2p.h, up1p1l.h, up1p2v.h) take rays that are already in this frame, so that a
// RANSAC turns every ray once and not once a sample.
#pragma once

#include <Eigen/Core>

namespace maploc {

// A yaw as its cosine and sine: no trigonometry on the way.
struct Yaw {
  double cosine = 1.0;
  double sine = 0.0;
};

// Rz(yaw) v.
inline Eigen::Vector3d TurnByYaw(const Yaw& yaw, const Eigen::Vector3d& v) {
  return {yaw.cosine * v.x() - yaw.sine * v.y(), yaw.sine * v.x() + yaw.cosine * v.y(), v.z()};
}

// aligned_from_map.
struct AlignedPose {
  Yaw yaw;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point_in_map) const {
    return TurnByYaw(yaw, point_in_map) + translation;
  }
};

// The pose that sees `point` at `depth` along `ray`: t = depth ray - Rz P. One coordinate at a time
// on purpose: Eigen would join two into a packet through memory, and wait for it.
inline void WritePoseAtDepth(const Yaw& yaw, double depth, const Eigen::Vector3d& ray,
                             const Eigen::Vector3d& point, AlignedPose* aligned_from_map) {
  const double x = depth * ray.x() - (yaw.cosine * point.x() - yaw.sine * point.y());
  const double y = depth * ray.y() - (yaw.sine * point.x() + yaw.cosine * point.y());
  const double z = depth * ray.z() - point.z();
  aligned_from_map->yaw = yaw;
  aligned_from_map->translation.x() = x;
  aligned_from_map->translation.y() = y;
  aligned_from_map->translation.z() = z;
}

inline Eigen::Matrix3d RotationMatrix(const Yaw& yaw) {
  Eigen::Matrix3d rotation;
  rotation << yaw.cosine, -yaw.sine, 0, yaw.sine, yaw.cosine, 0, 0, 0, 1;
  return rotation;
}

}  // namespace maploc
