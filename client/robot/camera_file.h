// A camera's calibration from a file: the first line of a COLMAP cameras.txt that is neither blank
// nor a comment, or an EuRoC sensor.yaml (told by its name, .yaml or .yml).
#pragma once

#include <string>

#include "mapstore/base/status.h"
#include "mapstore/geometry/camera.h"

namespace maploc {

// Error: names the file, and the line where there is one.
Result<Camera> ReadCameraFile(const std::string& path);

}  // namespace maploc
