// COLMAP's binary model. Only for this folder.
#pragma once

#include <string>

#include "mapstore/formats/colmap.h"

namespace maploc {

// DIR/{cameras,images,points3D}.bin. Errors name "file: byte OFFSET".
Result<ColmapModel> ReadColmapBinaryModel(const std::string& directory);

}  // namespace maploc
