#include "tests/support/moved_signs.h"

#include "mapstore/geometry/rigid3.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kFocalPx = 500.0;
constexpr double kNoisePx = 0.7;
constexpr double kRadius = 0.1;  // of a sign, in metres

// At the height of eyes, looking along x.
Rigid3 LevelCamera() {
  Eigen::Matrix3d rotation;
  rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return {Eigen::Quaterniond(rotation), {0, 1.5, 0}};
}

Eigen::Vector2d InUnitDisc(Random& random) {
  Eigen::Vector2d point;
  do {
    const double x = random.Uniform(-1, 1);
    const double y = random.Uniform(-1, 1);
    point = {x, y};
  } while (point.norm() > 1);
  return point;
}

Eigen::Vector2d PixelWithin(double half_width, double half_height, Random& random) {
  const double x = random.Uniform(-half_width, half_width);
  const double y = random.Uniform(-half_height, half_height);
  return {x, y};
}

// On a wall 20 m away, half a metre deep.
Eigen::Vector3d PlaceInMap(Random& random) {
  const double x = 20 + random.Uniform(-0.5, 0.5);
  const double y = random.Uniform(-4, 4);
  return {x, y, random.Uniform(0.3, 2.7)};
}

void AddSign(const MovedSignsOptions& options, Random& random, PoseProblem* problem) {
  const Eigen::Vector2d seen = PixelWithin(260, 180, random);
  const Eigen::Vector3d known = PlaceInMap(random);
  for (int i = 0; i < options.features; ++i) {
    const Eigen::Vector2d spot = InUnitDisc(random);
    const double x = random.Gaussian(kNoisePx);
    const double y = random.Gaussian(kNoisePx);
    problem->points.push_back(
        {.normalized = (seen + options.radius_px * spot + Eigen::Vector2d(x, y)) / kFocalPx,
         .position_in_map = known - kRadius * Eigen::Vector3d(0, spot.x(), spot.y())});
  }
}

}  // namespace

PoseProblem MakeMovedSigns(const MovedSignsOptions& options, Random& random) {
  PoseProblem problem;
  problem.focal_length_px = kFocalPx;
  problem.gravity_sigma_rad = options.gravity_sigma_rad;
  problem.gravity_in_camera =
      NoisyGravityInCamera(LevelCamera(), options.gravity_sigma_rad, random);
  for (int sign = 0; sign < options.signs; ++sign) AddSign(options, random, &problem);
  for (int i = 0; i < options.others; ++i) {
    problem.points.push_back({.normalized = PixelWithin(320, 240, random) / kFocalPx,
                              .position_in_map = PlaceInMap(random)});
  }
  return problem;
}

}  // namespace maploc::testing
