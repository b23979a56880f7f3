// From a model's own frame to the map's: gravity on (0, 0, -1), lengths in the map's unit.
#pragma once

#include <optional>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/formats/colmap.h"
#include "mapstore/geometry/gravity.h"
#include "mapstore/importers/tracks.h"

namespace maploc {

struct SourceGravity {
  GravityEstimate estimate;  // spread 0 when it was given
  bool is_given = false;
};

// The given direction (any length but 0; down), or else an estimate from the photos' poses. Errors:
// gravity zero or not finite; not given and the poses do not determine it.
Result<SourceGravity> FindSourceGravity(const ColmapModel& model,
                                        const std::optional<Eigen::Vector3d>& given);

// The rotation that puts gravity on (0, 0, -1), and the scale. REQUIRES: a unit vector; positive.
Similarity3 AlignSource(const Eigen::Vector3d& gravity_in_source, double map_units_per_unit);

// The model's images, ascending by image id, moved into the map's frame.
std::vector<KeyFrame> MakeKeyFrames(const ColmapModel& model, const Similarity3& map_from_source);

}  // namespace maploc
