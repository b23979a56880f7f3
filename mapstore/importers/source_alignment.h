// From a model's own frame to the map's: gravity on (0, 0, -1), lengths in the map's unit.
#pragma once

#include <vector>

#include "mapstore/formats/colmap.h"
#include "mapstore/importers/tracks.h"

namespace maploc {

// The rotation that puts gravity on (0, 0, -1), and the scale. REQUIRES: a unit vector; positive.
Similarity3 AlignSource(const Eigen::Vector3d& gravity_in_source, double map_units_per_unit);

// The model's images, ascending by image id, moved into the map's frame.
std::vector<KeyFrame> MakeKeyFrames(const ColmapModel& model, const Similarity3& map_from_source);

}  // namespace maploc
