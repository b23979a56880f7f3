// 3D lines from the segments detected in posed photos, in three steps:
// 1. every segment of every frame is paired, over the neighbouring frames, with the segments whose
//    descriptors are near and whose planes cut it in front of both cameras; each pair is a proposal
//    for its 3D line, and the other neighbours' candidates vote for it;
// 2. the proposal with the most votes is refined over all that voted (line_geometry.h);
// 3. the best lines first, each takes the segments that show it in any frame; what is left with
//    three frames or more, a small error and a small uncertainty is a landmark.
// After "proposals and scoring" in Liu et al., "3D Line Mapping Revisited", CVPR 2023, with votes
// by reprojection instead of their scored similarity. Deterministic, whatever the number of
// threads.
#pragma once

#include <span>
#include <vector>

#include "mapstore/importers/parallel.h"
#include "mapstore/importers/tracks.h"
#include "mapstore/model/descriptor.h"

namespace maploc {

// The segments detected in one frame, undistorted.
struct FrameLines {
  std::vector<LineSegment2> normalized;
  Descriptors descriptors;  // one row a segment; Hamming
};

// REQUIRES: lines and neighbours have one entry a frame.
std::vector<LineTrackInMap> TriangulateLines(std::span<const KeyFrame> frames,
                                             std::span<const FrameLines> lines,
                                             std::span<const std::vector<int>> neighbours,
                                             const ProgressFn& progress = nullptr);

}  // namespace maploc
