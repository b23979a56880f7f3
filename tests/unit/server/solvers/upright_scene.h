// Noise-free scenes for the solvers: a camera with known gravity, points in front of it, lines
// through such points.
#pragma once

#include <numbers>

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

// 500 km from the origin. Coordinates are rounded to 3e-11 m there, which rays of stored points
// know (RayTo). The solvers take differences of positions first, so a rotation is as exact as near
// the origin, and a position as exact as its coordinates.
inline const Eigen::Vector3d kFarAway(4e5, -3e5, 100);
// Turning a vector of 5e5 m by a quaternion, and back to the centre, is some thirty roundings of up
// to 6e-11 m.
inline constexpr double kFarPositionError = 2e-9;

}  // namespace maploc::testing
