#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "mapstore/geometry/rigid3.h"
#include "tests/support/repeated_pattern.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kFocalPx = 500.0;
constexpr double kHalfWidthPx = 320.0;
constexpr double kHalfHeightPx = 240.0;
constexpr double kNoisePx = 0.7;
constexpr double kWall = 1.5;  // metres from the middle of the corridor
constexpr double kNearest = 0.3;

// Looking along x within a few degrees, level.
Rigid3 CameraAlong(Random& random) {
  const double yaw = random.Uniform(-0.15, 0.15);
  Eigen::Matrix3d rotation;
  rotation << std::sin(yaw), -std::cos(yaw), 0, 0, 0, -1, std::cos(yaw), std::sin(yaw), 0;
  const Eigen::Vector3d centre(-random.Uniform(1, 3), random.Uniform(-0.5, 0.5), 1.5);
  return {Eigen::Quaterniond(rotation).normalized(), -(rotation * centre)};
}

// Another door for every door, one to one.
std::vector<int> OtherDoors(int doors, Random& random) {
  std::vector<int> others(static_cast<std::size_t>(doors));
  std::iota(others.begin(), others.end(), 0);
  bool all_other = false;
  while (!all_other) {
    for (std::uint32_t i = static_cast<std::uint32_t>(doors); i > 1; --i) {
      std::swap(others[i - 1], others[random.Below(i)]);
    }
    all_other = true;
    for (int door = 0; door < doors; ++door) {
      all_other = all_other && others[static_cast<std::size_t>(door)] != door;
    }
  }
  return others;
}

void AddIfSeen(const Rigid3& camera_from_map, const Eigen::Vector3d& seen,
               const Eigen::Vector3d& known, Random& random, PoseProblem* problem) {
  const Eigen::Vector3d in_camera = camera_from_map * seen;
  if (in_camera.z() < kNearest) return;
  const double x = random.Gaussian(kNoisePx);
  const double y = random.Gaussian(kNoisePx);
  const Eigen::Vector2d pixel = kFocalPx * in_camera.hnormalized() + Eigen::Vector2d(x, y);
  if (std::abs(pixel.x()) > kHalfWidthPx || std::abs(pixel.y()) > kHalfHeightPx) return;
  problem->points.push_back({.normalized = pixel / kFocalPx, .position_in_map = known});
}

}  // namespace

PoseProblem MakeRepeatedCorridor(const RepeatedCorridorOptions& options, Random& random) {
  const Rigid3 camera_from_map = CameraAlong(random);
  const double step = random.Uniform(2, 4);
  PoseProblem problem;
  problem.focal_length_px = kFocalPx;
  problem.gravity_sigma_rad = options.gravity_sigma_rad;
  problem.gravity_in_camera =
      NoisyGravityInCamera(camera_from_map, options.gravity_sigma_rad, random);
  std::vector<Eigen::Vector3d> spots;
  for (int i = 0; i < options.spots; ++i) {
    const double along = random.Uniform(0, 1.2);
    spots.emplace_back(along, 0, random.Uniform(0, 2.4));
  }
  for (int wall = 0; wall < options.walls; ++wall) {
    const double across = wall == 0 ? -kWall : kWall;
    for (const Eigen::Vector3d& spot : spots) {
      const std::vector<int> others = OtherDoors(options.doors, random);
      for (int door = 0; door < options.doors; ++door) {
        const int other = others[static_cast<std::size_t>(door)];
        AddIfSeen(camera_from_map, spot + Eigen::Vector3d(door * step, across, 0),
                  spot + Eigen::Vector3d(other * step, across, 0), random, &problem);
      }
    }
  }
  return problem;
}

}  // namespace maploc::testing
