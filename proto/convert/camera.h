// The wire's camera. Internal to proto/convert.
#pragma once

#include <string>

#include "maploc/v1/types.pb.h"
#include "mapstore/base/status.h"
#include "mapstore/geometry/camera.h"

namespace maploc::convert {

// Beside what Camera::Create checks: focal lengths in [kMinFocalLengthPx, kMaxFocalLengthPx] and
// the principal point within kMaxCoordinatePx, so that no ray overflows.
Result<Camera> CameraFromProto(const v1::Camera& camera, const std::string& field);
void CameraToProto(const Camera& camera, v1::Camera* proto);

inline constexpr double kMinFocalLengthPx = 0.1;
inline constexpr double kMaxFocalLengthPx = 1e7;

}  // namespace maploc::convert
