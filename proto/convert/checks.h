// What every parser of this folder checks, each error with the field's path in front. Internal to
// proto/convert.
#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "maploc/v1/types.pb.h"
#include "mapstore/base/status.h"
#include "mapstore/model/strategy.h"

namespace maploc::convert {

// Far above what any camera of 65536 px can see; keeps squares of pixels finite in float.
inline constexpr double kMaxCoordinatePx = 131072.0;
// Far above any map; keeps squares of positions exact enough to compare.
inline constexpr double kMaxPosition = 1e9;

// "views[3]"
std::string At(const std::string& field, std::size_t index);

// As CheckName (mapstore/base/name.h), and not empty.
Status CheckRequiredName(const std::string& field, const std::string& value);
// The field `map_version`: 0 or a version.
Status CheckMapVersion(std::int64_t version);
// UNKNOWN_ENUM_VALUE.
Status UnknownEnum(const std::string& field, int value);

// Finite and each component within +-limit.
Result<Eigen::Vector3d> VectorFromProto(const v1::Vector3& vector, const std::string& field,
                                        double limit = kMaxPosition);
void VectorToProto(const Eigen::Vector3d& vector, v1::Vector3* proto);

// Norm within 1e-3 of 1; normalized.
Result<Eigen::Quaterniond> QuaternionFromProto(const v1::Quaternion& quaternion,
                                               const std::string& field);
void QuaternionToProto(const Eigen::Quaterniond& quaternion, v1::Quaternion* proto);

// UNSPECIFIED is refused; the caller treats it first where it has a meaning.
Result<Strategy> StrategyFromProto(v1::Strategy strategy, const std::string& field);
v1::Strategy StrategyToProto(Strategy strategy);

}  // namespace maploc::convert
