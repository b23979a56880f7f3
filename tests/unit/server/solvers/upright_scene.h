// Noise-free scenes for the solvers: a camera with known gravity, points in front of it, lines
// through such points.
#pragma once

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <vector>

#include "mapstore/base/random.h"
#include "mapstore/geometry/gravity.h"
#include "mapstore/geometry/rigid3.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {

inline constexpr double kDegree = std::numbers::pi / 180.0;

struct UprightScene {
  Rigid3 camera_from_map;
  Eigen::Vector3d gravity_in_camera;
  Eigen::Vector3d centre_in_map;  // of the camera

  Eigen::Vector3d PointInMap(const Eigen::Vector3d& ray_in_camera, double depth) const {
    return camera_from_map.Inverse() * Eigen::Vector3d(depth * ray_in_camera);
  }
  // Of a point as it is stored, rounding and all; not scaled to z = 1. The difference is exact
  // where both are far away, so that the sample is free of noise there too.
  Eigen::Vector3d RayTo(const Eigen::Vector3d& point_in_map) const {
    return camera_from_map.rotation * (point_in_map - centre_in_map);
  }
};

// A camera of any attitude at `centre`.
inline UprightScene MakeScene(Random& random,
                              const Eigen::Vector3d& centre = Eigen::Vector3d::Zero()) {
  UprightScene scene;
  scene.camera_from_map.rotation = RandomRotation(random);
  scene.camera_from_map.translation = -(scene.camera_from_map.rotation * centre);
  scene.gravity_in_camera = GravityInCamera(scene.camera_from_map.rotation);
  scene.centre_in_map = centre;
  return scene;
}

// A camera whose aligned frame differs from the map by exactly this yaw.
inline UprightScene MakeSceneWithYaw(double cosine, double sine, Random& random) {
  UprightScene scene = MakeScene(random);
  Eigen::Matrix3d yaw;
  yaw << cosine, -sine, 0, sine, cosine, 0, 0, 0, 1;
  scene.camera_from_map.rotation =
      (CameraFromAligned(scene.gravity_in_camera) * Eigen::Quaterniond(yaw)).normalized();
  scene.camera_from_map.translation = RandomDirection(random);
  scene.centre_in_map = scene.camera_from_map.Inverse().translation;
  return scene;
}

// A ray of a camera with a field of view of 90 degrees, z = 1.
inline Eigen::Vector3d RandomRay(Random& random) {
  const double x = random.Uniform(-1, 1);
  const double y = random.Uniform(-1, 1);
  return {x, y, 1.0};
}

// Rotation error of the best of `count` poses; pi when there is none.
inline double BestRotationError(const Rigid3* poses, int count, const Rigid3& truth) {
  double best = std::numbers::pi;
  for (int i = 0; i < count; ++i) {
    best = std::min(best, ComparePoses(poses[i], truth).rotation_rad);
  }
  return best;
}

inline double BestPositionError(const Rigid3* poses, int count, const Rigid3& truth) {
  double best = 1e300;
  for (int i = 0; i < count; ++i) best = std::min(best, ComparePoses(poses[i], truth).position);
  return best;
}

inline double Percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

// 500 km from the origin. Coordinates are rounded to 3e-11 m there, which rays of stored points
// know (RayTo). The solvers take differences of positions first, so a rotation is as exact as near
// the origin, and a position as exact as its coordinates.
inline const Eigen::Vector3d kFarAway(4e5, -3e5, 100);
// Turning a vector of 5e5 m by a quaternion, and back to the centre, is some thirty roundings of up
// to 6e-11 m.
inline constexpr double kFarPositionError = 2e-9;

// A pose is missed when none of those found is nearer than this. (Near a double root an answer may
// be off by the square root of its rounding, and the solvers clamp a double root within 1e-5.)
inline constexpr double kMissedRad = 1e-5;

// What is asked of a solver, and printed for its README.
struct ErrorSummary {
  int missed = 0;
  double median = 0.0, percent99 = 0.0, percent999 = 0.0, worst = 0.0;
};

inline ErrorSummary Summarize(const std::vector<double>& rotation_errors) {
  ErrorSummary summary;
  for (const double error : rotation_errors) summary.missed += error > kMissedRad ? 1 : 0;
  summary.median = Percentile(rotation_errors, 0.5);
  summary.percent99 = Percentile(rotation_errors, 0.99);
  summary.percent999 = Percentile(rotation_errors, 0.999);
  summary.worst = Percentile(rotation_errors, 1.0);
  std::cout << rotation_errors.size() << " problems, rotation error: median " << summary.median
            << ", 99% " << summary.percent99 << ", 99.9% " << summary.percent999 << ", worst "
            << summary.worst << ", missed " << summary.missed << std::endl;
  return summary;
}

inline constexpr int kManyProblems = 100000;
inline constexpr double kAllButFive = 0.99995;  // of so many
inline constexpr int kSeeds = 3;

}  // namespace maploc::testing
