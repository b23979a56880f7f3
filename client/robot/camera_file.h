// A photo's calibration from a file: COLMAP's cameras (cameras.txt, cameras.bin or a model's
// folder), or an EuRoC sensor.yaml (told by its name, .yaml or .yml,
// in any case).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "mapstore/base/status.h"
#include "mapstore/geometry/camera.h"

namespace maploc {

struct CameraChoice {
  std::string file;
  std::string photo;                      // the image's path; may be empty
  std::optional<std::int64_t> camera_id;  // --camera-id
};

// The camera of that id, where one is given; else the only one; else the one that the model's
// images (images.txt beside a cameras.txt) have for the photo: the image whose name is the end of
// the photo's path, of several the longest. Error: names the file, and the line where there is one;
// INVALID_FILE (AMBIGUOUS_CAMERA) with the ids and the cure where several are left.
Result<Camera> ReadCameraFile(const CameraChoice& choice);

}  // namespace maploc
