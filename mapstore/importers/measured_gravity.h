// Gravity that the photos' own sensors measured (pose_priors in COLMAP's database).
#pragma once

#include <optional>
#include <span>

#include "mapstore/importers/direction_fit.h"

namespace maploc {

// Fewer measurements do not tell how good they are.
inline constexpr int kMinMeasurements = 3;

// The robust mean of unit vectors pointing down; some may be wrong altogether. The covariance is
// from their scatter, and has a floor for what all sensors of one make share. nullopt: fewer than
// kMinMeasurements agree within 15 degrees, or these are no clear majority.
std::optional<DirectionFit> FitMeasuredGravity(std::span<const Eigen::Vector3d> down_in_source);

}  // namespace maploc
