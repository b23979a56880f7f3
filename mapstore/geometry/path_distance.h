// How far a place is from where the map was made.
#pragma once

#include <limits>
#include <span>

#include <Eigen/Core>

namespace maploc {

// Distance from `point` to the polyline through `path`, in its unit; infinite for an empty path.
double DistanceToPath(const Eigen::Vector3d& point, std::span<const Eigen::Vector3d> path);

}  // namespace maploc
