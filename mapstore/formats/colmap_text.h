// COLMAP's text model. Only for this folder.
#pragma once

#include <string>

#include "mapstore/formats/colmap.h"

namespace maploc {

// DIR/{cameras,images,points3D}.txt. Errors name file:line.
Result<ColmapModel> ReadColmapTextModel(const std::string& directory);

}  // namespace maploc
