// Angles and directions as messages have them.
#pragma once

#include <array>
#include <cstdio>
#include <numbers>
#include <string>

#include <Eigen/Core>

namespace maploc {

inline std::string Degrees(double radians) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.3g degrees", radians * 180 / std::numbers::pi);
  return text.data();
}

// "0.012,0.98,-0.2", as --gravity takes it.
inline std::string DirectionText(const Eigen::Vector3d& direction) {
  std::array<char, 96> text;
  std::snprintf(text.data(), text.size(), "%.4g,%.4g,%.4g", direction.x(), direction.y(),
                direction.z());
  return text.data();
}

}  // namespace maploc
