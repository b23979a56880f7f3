// Gravity: a unit vector pointing DOWN. In every map it is exactly (0, 0, -1).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace maploc {

inline const Eigen::Vector3d kGravityInMap(0.0, 0.0, -1.0);

// The shortest rotation `camera_from_aligned` with R * (0, 0, -1) =
// gravity_in_camera. Well defined for every unit vector: for gravity along +z it is a half turn
// about x. In the aligned frame only yaw and translation are unknown. REQUIRES: |gravity_in_camera|
// = 1 within 1e-6.
Eigen::Quaterniond CameraFromAligned(const Eigen::Vector3d& gravity_in_camera);

// The direction of gravity that a pose implies, in the camera. The pose's map has z up.
Eigen::Vector3d GravityInCamera(const Eigen::Quaterniond& camera_from_map);

// Angle in radians between two unit vectors, in [0, pi]; accurate near 0 and pi.
double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

// A stated standard deviation below this counts as this (0.006 degrees): no accelerometer is exact,
// a covariance of zero in roll and pitch is a lie, and equations with gravity stay regular.
inline constexpr double kMinGravitySigmaRad = 1e-4;

}  // namespace maploc
