// The lenses, at the same pixels a radian but for 4K's.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mapstore/base/random.h"
#include "tests/integration/any_camera/place.h"
#include "tests/support/seen_through.h"

namespace maploc::testing {

struct Lens {
  std::string name;
  Camera camera;
  double rim_rad = 0.0;  // half of what it shows; 0: what is looked at stays in the middle
};

inline constexpr double kFocalPx = 500.0;

inline Lens VgaPinhole() {
  return {
      "VGA pinhole",
      Camera::Create(CameraModel::kPinhole, 640, 480, {kFocalPx, kFocalPx, 319.5, 239.5}).value()};
}

inline Lens Fisheye(int degrees, double focal_px = kFocalPx) {
  return {"fisheye of " + std::to_string(degrees) +
              ", f = " + std::to_string(static_cast<int>(focal_px)),
          FisheyeOf(degrees, focal_px), 0.5 * degrees * kRadPerDeg};
}

// Bent as real ones are.
inline Lens FourK() {
  const double focal_px = kFocalPx * std::hypot(3840, 2160) / std::hypot(640, 480);
  return {"4K", Camera::Create(CameraModel::kOpenCv, 3840, 2160,
                               {focal_px, focal_px, 1919.5, 1079.5, -0.1, 0.02, 1e-3, -1e-3})
                    .value()};
}

// A turn of the lens that brings what lies `reach_rad` about the axis to anywhere between the
// middle and the rim.
inline Eigen::Quaterniond TurnOf(const Lens& lens, double reach_rad, Random& random) {
  const double room_rad = std::max(lens.rim_rad - reach_rad - 0.01, 0.0);
  const double around = random.Uniform(0, 2 * std::numbers::pi);
  const Eigen::Vector3d axis(std::cos(around), std::sin(around), 0);
  return Eigen::Quaterniond(Eigen::AngleAxisd(random.Uniform(0, room_rad), axis));
}

}  // namespace maploc::testing
