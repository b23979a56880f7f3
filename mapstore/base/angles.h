// Files and messages tell angles in degrees; all values in memory are radians.
#pragma once

#include <numbers>

namespace maploc {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;

}  // namespace maploc
