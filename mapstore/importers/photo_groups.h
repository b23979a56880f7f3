// Cuts unordered photos into segments: photos that see the same landmarks, taken near each other.
#pragma once

#include <span>
#include <vector>

#include "mapstore/importers/tracks.h"

namespace maploc {

// Joins the two groups whose photos share most landmarks (on average, a pair), as long as all
// photos of a group were taken within `extent` (diagonal of a box, map units); begins with one
// photo a group. Every frame is in exactly one group; ascending in each. Deterministic.
// O(pairs of photos that share landmarks, times their logarithm).
std::vector<std::vector<int>> GroupPhotos(std::span<const KeyFrame> frames,
                                          std::span<const PointTrack> points, double extent);

}  // namespace maploc
