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

// Pixels are those of the photos as their features were found (KeyFrame::FeaturePixel).
struct LineTriangulationOptions {
  int max_candidates = 10;             // of one segment in one neighbouring frame
  int max_descriptor_distance = 70;    // bits of 256 between views of one line
  double min_plane_angle_rad = 0.026;  // between a ray and the other view's plane (1.5 degrees)
  double min_overlap = 0.4;            // of the shorter of two segments
  double max_vote_error_px = 2.5;      // of a view that votes
  double max_error_px = 2.0;           // of a view that a landmark keeps
  int min_frames = 3;                  // that show a landmark
  double max_relative_sigma = 0.01;    // uncertainty across the line at 1 px of noise, over depth
};

// REQUIRES: lines and neighbours have one entry a frame.
std::vector<LineTrackInMap> TriangulateLines(std::span<const KeyFrame> frames,
                                             std::span<const FrameLines> lines,
                                             std::span<const std::vector<int>> neighbours,
                                             const LineTriangulationOptions& options = {},
                                             const ProgressFn& progress = nullptr);

}  // namespace maploc
