// Noise-free scenes for the solvers: a camera with known gravity, points in front of it, lines
// through such points.
#pragma once

#include <algorithm>
#include <cmath>
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

}  // namespace maploc::testing
