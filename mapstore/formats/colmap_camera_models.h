// COLMAP's camera models: all that version 4 knows, so that a file can be read past a camera that
// no image uses, and how each becomes one of maploc's. Only for this folder.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/geometry/camera.h"

namespace maploc {

// The reason of a refusal that means the model, not the numbers: the camera may stand in a file
// as long as no image uses it.
inline constexpr std::string_view kUnsupportedCameraModel = "UNSUPPORTED_CAMERA_MODEL";

// By COLMAP's number; "" beyond those that it has.
std::string_view ColmapModelName(std::int64_t model_id);
// REQUIRES: COLMAP has a model of this number.
int ColmapParamCount(std::int64_t model_id);

// `model_name` as COLMAP spells it; `params` as the file has them: the half pixel is taken off
// here. A fisheye with fewer coefficients than OPENCV_FISHEYE becomes one whose others are zero.
// Error: a wrong number of parameters, bad sides or values; kUnsupportedCameraModel, with the cure.
Result<Camera> MakeColmapCamera(std::string_view model_name, std::int64_t width_px,
                                std::int64_t height_px, std::vector<double> params);

}  // namespace maploc
