#include "mapstore/geometry/gravity_reading.h"

#include <cmath>
#include <sstream>

namespace maploc {

Result<Eigen::Vector3d> DownFromReading(std::string_view field, const Eigen::Vector3d& reading) {
  if (!reading.allFinite()) {
    return InvalidArgument(field, "is not finite; it must be the direction down", "NOT_FINITE");
  }
  // The squares of very large or very small numbers would overflow or vanish.
  const double norm = reading.stableNorm();
  if (norm == 0.0) {
    return InvalidArgument(field,
                           "is zero, which is no direction; it must point down, for example 0,1,0 "
                           "in an upright camera",
                           "ZERO_GRAVITY");
  }
  const bool unit = std::abs(norm - 1.0) <= kUnitReadingTolerance;
  const bool sensor = std::abs(norm / kStandardGravity - 1.0) <= kSensorReadingTolerance;
  if (unit || sensor) return Eigen::Vector3d(reading / norm);
  std::ostringstream message;
  message << "has the length " << norm
          << ", but gravity is a unit vector or 9.81 m/s^2 (within 20%); if only its length is "
             "wrong divide it by that, if it was read while the robot was shaken filter it";
  return InvalidArgument(field, message.str(), "IMPLAUSIBLE_GRAVITY");
}

Status CheckGravitySigmaDeg(std::string_view field, double sigma_deg) {
  if (sigma_deg > 0.0 && sigma_deg <= kMaxStatedGravitySigmaDeg) return Status::Ok();
  return InvalidArgument(field, "must be above 0 and at most 90 degrees");
}

}  // namespace maploc
