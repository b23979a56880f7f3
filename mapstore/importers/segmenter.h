// Cuts a map into segments: contiguous stretches of the key frames' path, which overlap so that a
// query at a border still sees its landmarks; or groups of unordered photos.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mapstore/importers/tracks.h"
#include "mapstore/model/map.h"

namespace maploc {

// Twice the median distance from a frame to the landmarks it sees: what is seen from one end of a
// stretch is then mostly seen from its other end too, whatever the unit.
double DefaultSegmentLength(std::span<const KeyFrame> frames, std::span<const PointTrack> points);

// The frames of each segment, in the path's order. Every frame is in at least one; segments that
// follow each other share frames (while there are more than one): at each end a quarter of a
// stretch's length is added, and two frames at least. `length` is of a stretch, in map units.
std::vector<std::vector<int>> CutPath(std::span<const KeyFrame> frames,
                                      const std::vector<int>& order, double length);

// CutPath where the frames were recorded along a path (frame_order.h). Unordered photos are grouped
// (photo_groups.h), each group as wide as a stretch with what is added to it, its frames ordered by
// nearness.
std::vector<std::vector<int>> CutIntoSegments(std::span<const KeyFrame> frames,
                                              std::span<const PointTrack> points, double length);

// All tracks of one kind, and their descriptors'.
template <typename Track>
struct TracksOfKind {
  std::span<const Track> tracks;
  DescriptorKind kind;
};

// Makes segments from frames and tracks, which must outlive it.
class SegmentMaker {
 public:
  SegmentMaker(std::span<const KeyFrame> frames, const TracksOfKind<PointTrack>& points,
               const TracksOfKind<LineTrackInMap>& lines);

  // A segment with all landmarks that one of its frames saw. Ids are the tracks' indices. O(what
  // the frames saw).
  Segment Make(SegmentId id, const std::vector<int>& segment_frames) const;

 private:
  // The tracks that each frame saw.
  struct Seen {
    template <typename Track>
    Seen(std::size_t frames, std::span<const Track> tracks);
    // Of any of the frames, ascending.
    std::vector<int> By(const std::vector<int>& frames) const;

    std::vector<std::size_t> begin;  // of each frame's in `landmarks`, and the end
    std::vector<int> landmarks;
  };

  std::span<const KeyFrame> frames_;
  TracksOfKind<PointTrack> points_;
  TracksOfKind<LineTrackInMap> lines_;
  Seen points_seen_;
  Seen lines_seen_;
};

}  // namespace maploc
