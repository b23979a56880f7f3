// What cannot be seen is no evidence: a wall of symmetric windows, seen mirrored, is that wall seen
// from behind, and every match agrees.
#pragma once

#include "mapstore/model/matches.h"
#include "server/refinement/refine.h"

namespace maploc {

// Can a landmark that was seen from `viewing` when the map was made be recognized from
// `camera_center_in_map`? No feature is matched that is turned by more than 60 degrees beyond the
// views of the map (Mikolajczyk et al. 2005: repeatability of all detectors ends there), or seen at
// a fifth of their least or five times their largest distance. True where the range is not known.
// Thread-safe.
bool IsVisible(const ViewingRange& viewing, const Eigen::Vector3d& landmark_in_map,
               const Eigen::Vector3d& camera_center_in_map);

// The pose with the inliers alone that can be seen from it. Thread-safe.
RefinedPose WithoutUnseen(const PoseProblem& problem, RefinedPose pose);

}  // namespace maploc
