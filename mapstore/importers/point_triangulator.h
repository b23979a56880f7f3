// 3D points from keypoints detected in posed photos: matched between neighbouring frames, checked
// against the epipolar geometry that the poses give, joined to tracks, triangulated and refined.
#pragma once

#include <span>
#include <vector>

#include "mapstore/importers/parallel.h"
#include "mapstore/importers/tracks.h"
#include "mapstore/model/query.h"

namespace maploc {

// Points seen in three frames or more, or in two at a good angle; with the descriptors of all their
// observations. REQUIRES: features and neighbours have one entry a frame. Deterministic.
std::vector<PointTrack> TriangulatePoints(std::span<const KeyFrame> frames,
                                          std::span<const PointFeatures> features,
                                          std::span<const std::vector<int>> neighbours,
                                          const ProgressFn& progress = nullptr);

}  // namespace maploc
