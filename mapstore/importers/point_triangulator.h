// 3D points from keypoints detected in posed photos: matched between neighbouring frames, checked
// against the epipolar geometry that the poses give, joined to tracks, triangulated and refined.
#pragma once

#include <span>
#include <vector>

#include "mapstore/importers/parallel.h"
#include "mapstore/importers/tracks.h"
#include "mapstore/model/query.h"

namespace maploc {

// Pixels are those of the photos as their features were found (KeyFrame::FeaturePixel).
struct PointTriangulationOptions {
  float max_ratio = 0.8f;  // of descriptor distances
  double max_epipolar_error_px = 3.0;
  double max_error_px = 2.0;             // of an observation that a point keeps
  double min_angle_rad = 0.026;          // largest parallax of a point's rays (1.5 degrees)
  double min_two_view_angle_rad = 0.07;  // the same, of a point that only two frames saw
};

// Points seen in three frames or more, or in two at a good angle; with the descriptors of all their
// observations. REQUIRES: features and neighbours have one entry a frame. Deterministic.
std::vector<PointTrack> TriangulatePoints(std::span<const KeyFrame> frames,
                                          std::span<const PointFeatures> features,
                                          std::span<const std::vector<int>> neighbours,
                                          const PointTriangulationOptions& options = {},
                                          const ProgressFn& progress = nullptr);

}  // namespace maploc
