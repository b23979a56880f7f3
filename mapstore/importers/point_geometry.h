// The point that posed rays meet in.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "mapstore/geometry/rigid3.h"

namespace maploc {

struct PointObservation {
  Rigid3 camera_from_map;
  Eigen::Vector2d normalized = Eigen::Vector2d::Zero();
  double focal_length_px = 1.0;
};

// The distance in pixels between what was seen and the point's projection; huge when the point is
// not in front of the camera.
double PointErrorPx(const PointObservation& seen, const Eigen::Vector3d& point_in_map);

// The largest angle between two of the rays to the point.
double LargestParallax(std::span<const PointObservation> views,
                       const Eigen::Vector3d& point_in_map);

// The point nearest to all rays, then moved to the smallest reprojection error (Gauss-Newton, Huber
// at 1 px). nullopt when the rays do not determine it or it lies behind a camera.
std::optional<Eigen::Vector3d> TriangulatePoint(std::span<const PointObservation> views);

}  // namespace maploc
