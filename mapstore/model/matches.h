// Matches of a query's features with a segment's landmarks, and the geometric problem that is made
// from them. The problem needs neither the query nor the segment.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "mapstore/geometry/line.h"
#include "mapstore/geometry/pixel_frame.h"
#include "mapstore/model/viewing.h"

namespace maploc {

struct FeatureMatch {
  std::int32_t feature = 0;   // index into the view's keypoints or line segments
  std::int32_t landmark = 0;  // index into the segment's points or lines
  // Descriptor distance of this landmark divided by that of the next best landmark, in [0, 1]. A
  // smaller ratio means a more reliable match.
  float ratio = 1.0f;
};

// Each feature and each landmark occurs in at most one match.
struct Matches {
  std::vector<FeatureMatch> points;
  std::vector<FeatureMatch> lines;
};

// An observed point. `normalized` is its undistorted position in the camera's plane z = 1. A wide
// camera (Camera::IsWide) has no such plane: there `normalized` is (pixel - principal point) /
// Camera::MeanFocalLengthPx, and errors are computed from `frame`, whose `across` is divided by
// that too. So both kinds have the same unit, a pixel over the camera's focal length.
struct PointCorrespondence {
  Eigen::Vector2d normalized = Eigen::Vector2d::Zero();
  Eigen::Vector3d position_in_map = Eigen::Vector3d::Zero();
  double ratio = 1.0;      // FeatureMatch::ratio
  ViewingRange viewing{};  // of the landmark
  std::optional<PixelFrame> frame = std::nullopt;
};

// An observed line segment, by its two normalized end points. These need not be the images of the
// map segment's end points.
struct LineCorrespondence {
  LineSegment2 normalized;
  LineSegment3 segment_in_map;
  double ratio = 1.0;
  ViewingRange viewing{};                                          // of the landmark
  std::optional<std::array<PixelFrame, 2>> frames = std::nullopt;  // of start and end
};

// The input of the estimator. An error multiplied by focal_length_px is in pixels of a VGA-sized
// image (mapstore/geometry/pixel_scale.h). Either all features have frames or none has.
struct PoseProblem {
  double focal_length_px = 1.0;  // Camera::MeanFocalLengthPx / PixelScale; positive
  std::vector<PointCorrespondence> points;
  std::vector<LineCorrespondence> lines;
  // Unit vector, down; not used if `has_gravity` is false.
  Eigen::Vector3d gravity_in_camera = Eigen::Vector3d(0, 1, 0);
  double gravity_sigma_rad = 0.0;
  bool has_gravity = true;
  double shared_error_rad = 0.0;  // MapInfo::shared_error_rad
};

}  // namespace maploc
