// Landmarks that cannot be seen from a pose are no evidence for it. Example: a mirrored picture of
// a wall with symmetric windows fits a pose behind that wall, and all matches agree with it.
#pragma once

#include "mapstore/model/matches.h"
#include "server/refinement/refine.h"

namespace maploc {

// Can a landmark that was seen from `viewing` when the map was made be recognized from
// `camera_center_in_map`? False when it is viewed more than 90 degrees outside the map's range of
// views, or from less than a fifth of the least or more than five times the largest distance. (60
// degrees, where the repeatability of detectors ends according to Mikolajczyk et al. 2005, dropped
// true inliers: MEASUREMENTS.md.) True where the range is not known. Thread-safe.
bool IsVisible(const ViewingRange& viewing, const Eigen::Vector3d& landmark_in_map,
               const Eigen::Vector3d& camera_center_in_map);

// The pose without the inliers that cannot be seen from it. Thread-safe.
RefinedPose WithoutUnseen(const PoseProblem& problem, RefinedPose pose);

}  // namespace maploc
