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

// Covariance of a point that is triangulated from these frames with independent noise of 1 px along
// each image axis: (sum over frames of J^T J)^-1, J the derivative of the pixel (plane z = 1 times
// focal length; of a wide camera the pixel itself) by the position. Where the frames do not
// determine the position, the variance in that direction is the square of the largest distance to
// them. A frame that has the point behind it (a fisheye: beyond what it reaches) does not count;
// without any, all zero.
PositionCovariance CovarianceFromFrames(const Eigen::Vector3d& position_in_map,
                                        std::span<const KeyFrame> frames,
                                        std::span<const std::int32_t> seen_by);

}  // namespace maploc
