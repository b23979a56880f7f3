// The one rule for gravity that a person or a file states: as a unit vector, or in m/s^2 as a
// sensor tells it.
#pragma once

#include <Eigen/Core>

#include "mapstore/base/status.h"

namespace maploc {

inline constexpr double kStandardGravity = 9.80665;        // m/s^2
inline constexpr double kUnitReadingTolerance = 0.05;      // written with few digits
inline constexpr double kSensorReadingTolerance = 0.2;     // a share: bias, and a robot that moves
inline constexpr double kMaxStatedGravitySigmaDeg = 90.0;  // the wire's bound

// `reading` normalized, where its norm is 1 within kUnitReadingTolerance or kStandardGravity within
// kSensorReadingTolerance. Else INVALID_ARGUMENT with `field` in front and the cure: a vector of
// another length is no gravity (a filter's state, another unit, a shaken robot), and its direction
// cannot be trusted.
Result<Eigen::Vector3d> DownFromReading(std::string_view field, const Eigen::Vector3d& reading);

// INVALID_ARGUMENT unless `sigma_deg`, the standard deviation sent with a gravity, is in
// (0, kMaxStatedGravitySigmaDeg].
Status CheckGravitySigmaDeg(std::string_view field, double sigma_deg);

}  // namespace maploc
