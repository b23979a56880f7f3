// Cuts a map into segments: contiguous stretches of the key frames' path, which overlap so that a
// query at a border still sees its landmarks.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mapstore/importers/tracks.h"
#include "mapstore/model/map.h"

namespace maploc {

// The frames in the order in which the robot passed them. By name, numbers in names by their value
// ("img2" before "img10"), as recorders name them; but where that path is more than twice as long
// as the one that always goes to the nearest frame left (unordered photos), by the latter, from the
// frame farthest from the middle.
std::vector<int> OrderAlongPath(std::span<const KeyFrame> frames);

// Twice the median distance from a frame to the landmarks it sees: what is seen from one end of a
// stretch is then mostly seen from its other end too, whatever the unit.
double DefaultSegmentLength(std::span<const KeyFrame> frames, std::span<const PointTrack> points);

// The frames of each segment, in the path's order. Every frame is in at least one; segments that
// follow each other share frames (while there are more than one): at each end a quarter of a
// stretch's length is added, and two frames at least. `length` is of a stretch, in map units.
std::vector<std::vector<int>> CutPath(std::span<const KeyFrame> frames,
                                      const std::vector<int>& order, double length);

// A segment with all landmarks that one of its frames saw. Ids are the tracks' indices.
Segment MakeSegment(SegmentId id, const std::vector<int>& segment_frames,
                    std::span<const KeyFrame> frames, std::span<const PointTrack> points,
                    const DescriptorKind& point_kind, std::span<const LineTrackInMap> lines,
                    const DescriptorKind& line_kind);

}  // namespace maploc
