// Lines: 3D segments between two end points, and what their direction says about yaw.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace maploc {

// A 2D segment in pixels (or in the normalized plane, where a name says so).
struct LineSegment2 {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
};

// A 3D segment, in the frame that its variable's name says.
struct LineSegment3 {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
};

// Tilt from the vertical in radians, in [0, pi/2]. 0 for a vertical line and for a segment without
// length.
inline double TiltFromVertical(const LineSegment3& line_in_map) {
  const Eigen::Vector3d d = line_in_map.end - line_in_map.start;
  return std::atan2(d.head<2>().norm(), std::abs(d.z()));
}

// 1P1L draws lines of at least this tilt alone: a vertical line with a point does not determine
// the yaw (server/solvers/README.md).
inline constexpr double kMinUsableTiltRad = 10.0 * 3.14159265358979323846 / 180.0;

inline bool IsUsableLine(const LineSegment3& line_in_map) {
  return TiltFromVertical(line_in_map) >= kMinUsableTiltRad;
}

}  // namespace maploc
