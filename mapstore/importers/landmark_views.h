// What the key frames that saw a landmark say about it (model/viewing.h). All of them count, also
// those outside of a segment: a landmark says the same in every segment that holds it.
#pragma once

#include <cstdint>
#include <span>

#include "mapstore/importers/tracks.h"
#include "mapstore/model/viewing.h"

namespace maploc {

// From where the frames of `seen_by` (indices into `frames`) saw a landmark. A line's position is
// the middle of its segment.
ViewingRange ViewingFromFrames(const Eigen::Vector3d& position_in_map,
                               std::span<const KeyFrame> frames,
                               std::span<const std::int32_t> seen_by);

}  // namespace maploc
