// Matches near where a known pose projects the landmarks: thousands of times fewer comparisons than
// MatchSegment makes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/map.h"
#include "mapstore/model/matches.h"
#include "mapstore/model/query.h"

namespace maploc {

// Points of `view` within `radius_px` of a landmark's projection under `camera_from_map`, as
// similar as nine tenths of the inliers among `known`. A landmark goes to its nearest feature in
// there, and a feature takes the nearest of those that come to it. The features and landmarks of
// `known` are left out. Ratios are 1 (not known). By ascending feature.
//
// `known` are matches that were found without the pose; `known_inlier` says which agree with it
// (not 0). What this adds agrees with the pose because it was looked for there: it makes a pose
// more precise, and is no evidence for it. REQUIRES: the kinds are equal; an inlier; radius_px > 0.
// Deterministic; thread-safe.
std::vector<FeatureMatch> MatchNearProjections(const View& view, const Segment& segment,
                                               const Rigid3& camera_from_map, double radius_px,
                                               std::span<const FeatureMatch> known,
                                               std::span<const std::uint8_t> known_inlier);

}  // namespace maploc
