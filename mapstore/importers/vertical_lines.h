// The vertical lines of a scene, found as one vanishing direction in all its posed photos.
//
// A segment seen in a photo and the camera's centre span a plane; its normal n is perpendicular to
// the line in space. All photos' normals stand in one frame, so that the vertical is the direction
// v with n . v = 0 for the most of them, near what the camera levels leave open. Segments are used
// as they are detected: 3D lines would cost their baselines' errors and lose the lines that only
// two photos show. Building edges give an axis and never a sign: v takes the levels' side.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Geometry>

#include "mapstore/importers/camera_levels.h"
#include "mapstore/importers/direction_fit.h"
#include "mapstore/importers/line_triangulator.h"

namespace maploc {

struct VerticalLines {
  DirectionFit down_in_source;
  int segments = 0;
  int photos = 0;  // that show at least kMinVerticalsInPhoto of them
};

// nullopt: fewer than three photos show verticals, or two families of lines compete within what the
// levels leave open. The covariance is from the scatter between photos, and has a floor for what
// builders leave. Deterministic. REQUIRES: one entry of `lines` a photo.
std::optional<VerticalLines> FindVerticalLines(
    std::span<const Eigen::Quaterniond> camera_from_source, std::span<const FrameLines> lines,
    const CameraLevels& levels);

}  // namespace maploc
