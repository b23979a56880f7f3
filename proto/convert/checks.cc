#include "proto/convert/checks.h"

#include <cmath>

#include "mapstore/base/name.h"

namespace maploc::convert {

std::string At(const std::string& field, std::size_t index) {
  return field + "[" + std::to_string(index) + "]";
}

Status CheckRequiredName(const std::string& field, const std::string& value) {
  if (value.empty()) return InvalidArgument(field, "is required", "REQUIRED");
  return CheckName(field, value);
}

Status CheckMapVersion(std::int64_t version) {
  if (version >= 0) return Status::Ok();
  return InvalidArgument("map_version", "must not be negative; 0 takes any", "OUT_OF_RANGE");
}

Status UnknownEnum(const std::string& field, int value) {
  return InvalidArgument(field, "holds the unknown value " + std::to_string(value),
                         "UNKNOWN_ENUM_VALUE");
}

Result<Eigen::Vector3d> VectorFromProto(const v1::Vector3& vector, const std::string& field,
                                        double limit) {
  const Eigen::Vector3d result(vector.x(), vector.y(), vector.z());
  if (!result.allFinite()) return InvalidArgument(field, "must be finite", "NOT_FINITE");
  if (result.cwiseAbs().maxCoeff() > limit) {
    return InvalidArgument(field, "is out of range", "OUT_OF_RANGE");
  }
  return result;
}

void VectorToProto(const Eigen::Vector3d& vector, v1::Vector3* proto) {
  proto->set_x(vector.x());
  proto->set_y(vector.y());
  proto->set_z(vector.z());
}

Result<Eigen::Quaterniond> QuaternionFromProto(const v1::Quaternion& quaternion,
                                               const std::string& field) {
  const Eigen::Quaterniond result(quaternion.w(), quaternion.x(), quaternion.y(), quaternion.z());
  if (!result.coeffs().allFinite()) return InvalidArgument(field, "must be finite", "NOT_FINITE");
  // Numbers that were written with four digits pass; they are normalized below.
  constexpr double kNormTolerance = 1e-3;
  // stableNorm, because squares of huge components overflow and the message would name an infinite
  // norm.
  const double norm = result.coeffs().stableNorm();
  if (!(std::abs(norm - 1.0) <= kNormTolerance)) {
    return InvalidArgument(
        field, "must be a unit quaternion (x, y, z, w), its norm is " + std::to_string(norm),
        "NOT_UNIT_QUATERNION");
  }
  return result.normalized();
}

void QuaternionToProto(const Eigen::Quaterniond& quaternion, v1::Quaternion* proto) {
  proto->set_x(quaternion.x());
  proto->set_y(quaternion.y());
  proto->set_z(quaternion.z());
  proto->set_w(quaternion.w());
}

Result<Strategy> StrategyFromProto(v1::Strategy strategy, const std::string& field) {
  switch (strategy) {
    case v1::STRATEGY_1P1L:
      return Strategy::k1P1L;
    case v1::STRATEGY_2P:
      return Strategy::k2P;
    case v1::STRATEGY_MIXED:
      return Strategy::kMixed;
    case v1::STRATEGY_P3P:
      return Strategy::kP3P;
    default:
      return UnknownEnum(field, strategy);
  }
}

// Strategy has the wire's numbers. The other way needs the switch above: proto3 passes on numbers
// that this version does not know.
v1::Strategy StrategyToProto(Strategy strategy) { return static_cast<v1::Strategy>(strategy); }

}  // namespace maploc::convert
