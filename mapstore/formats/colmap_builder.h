// The checks that text and binary models share: a model grows by parts that are each valid, and
// refer only to parts that exist. Only for this folder. Errors name the field; the reader adds
// where the part stands.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "mapstore/formats/colmap.h"
#include "mapstore/formats/colmap_camera_models.h"

namespace maploc {

// Coordinates beyond this are garbage, and squares of them would overflow later on.
inline constexpr double kMaxColmapCoordinate = 1e12;

// From the quaternion w, x, y, z (any norm but 0) and translation of an image.
Result<Rigid3> MakeColmapPose(const std::array<double, 7>& wxyz_and_translation);

// `camera` as MakeColmapCamera left it: one of an unsupported model is kept aside.
Status AddColmapCamera(ColmapModel& model, std::int64_t id, Result<Camera> camera);
// Its camera must be there already, and be supported.
Status AddColmapImage(ColmapModel& model, ColmapImage image);
// Its images must be there already.
Status AddColmapPoint(ColmapModel& model, ColmapPoint point);

// After the points: every point that an image names exists. `where` gives an image's place.
Status CheckColmapPointIds(const ColmapModel& model,
                           const std::function<std::string(std::int64_t image_id)>& where);

}  // namespace maploc
