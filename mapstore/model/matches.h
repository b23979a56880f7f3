// Matches of a query's features with a segment's landmarks, and the self-contained geometric
// problem made from them.
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
  float ratio =
      1.0f;  // best distance over second best (of another landmark), in [0, 1]; smaller is surer
};

// At most one match a feature and one a landmark (mutual).
struct Matches {
  std::vector<FeatureMatch> points;
  std::vector<FeatureMatch> lines;
};

// A point seen at `normalized`: undistorted, in the plane z = 1 of the camera. Of a camera without
// such a plane (Camera::IsWide) it is the place in the image itself, without principal point and
// divided by the problem's focal_length_px; errors are then measured by `frame`, whose `across` is
// divided alike. So errors, lengths and distances times focal_length_px are pixels of either.
struct PointCorrespondence {
  Eigen::Vector2d normalized = Eigen::Vector2d::Zero();
  Eigen::Vector3d position_in_map = Eigen::Vector3d::Zero();
  double ratio = 1.0;      // FeatureMatch::ratio
  ViewingRange viewing{};  // of the landmark
  std::optional<PixelFrame> frame = std::nullopt;
};

// A segment seen between two normalized end points; they need not be the images of the map
// segment's end points.
struct LineCorrespondence {
  LineSegment2 normalized;
  LineSegment3 segment_in_map;
  double ratio = 1.0;
  ViewingRange viewing{};                                          // of the landmark
  std::optional<std::array<PixelFrame, 2>> frames = std::nullopt;  // of start and end
};

// What the estimator works on. Errors times focal_length_px are pixels, of a VGA-sized image
// (mapstore/geometry/pixel_scale.h). Either all features have frames or none has.
struct PoseProblem {
  double focal_length_px = 1.0;  // Camera::MeanFocalLengthPx / PixelScale; positive
  std::vector<PointCorrespondence> points;
  std::vector<LineCorrespondence> lines;
  Eigen::Vector3d gravity_in_camera =
      Eigen::Vector3d(0, 1, 0);  // unit, down; unused where `has_gravity` is false
  double gravity_sigma_rad = 0.0;
  bool has_gravity = true;
  double shared_error_rad = 0.0;  // MapInfo::shared_error_rad
};

}  // namespace maploc
