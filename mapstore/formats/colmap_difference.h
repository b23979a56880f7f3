// Whether two models are one, written in two forms. Only for this folder.
#pragma once

#include <string>

#include "mapstore/formats/colmap.h"

namespace maploc {

// The first thing in which `b` differs, "image 3 has another pose"; "" for models that are the same
// but for what six digits round off.
std::string FindModelDifference(const ColmapModel& a, const ColmapModel& b);

}  // namespace maploc
