// A validated localization query: proto/convert has checked every invariant named here, and later
// stages do not check again.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mapstore/base/ids.h"
#include "mapstore/geometry/camera.h"
#include "mapstore/geometry/line.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/descriptor.h"
#include "mapstore/model/strategy.h"

namespace maploc {

// Keypoints with one descriptor each, in pixels of the view's (distorted) image.
struct PointFeatures {
  std::vector<Eigen::Vector2f> keypoints_px;
  Descriptors descriptors;  // as many rows as keypoints
};

// Line segments with one descriptor each, in pixels of the view's (distorted) image.
struct LineFeatures {
  std::vector<Eigen::Vector2f> starts_px;
  std::vector<Eigen::Vector2f> ends_px;  // as many as starts; never equal to its start
  Descriptors descriptors;               // as many rows as segments

  int size() const { return static_cast<int>(starts_px.size()); }
};

struct View {
  Camera camera;
  Rigid3 camera_from_body;  // identity when the body is the camera
  PointFeatures points;
  LineFeatures lines;
};

struct Gravity {
  Eigen::Vector3d direction_in_body = Eigen::Vector3d(0, 1, 0);  // unit, down
  double sigma_rad = 0.0;  // standard deviation about each horizontal axis; >= 0
};

// Where the robot believes it is. A hint for choosing segments, never a constraint on the answer.
struct PosePrior {
  Eigen::Vector3d position_in_map = Eigen::Vector3d::Zero();
  double sigma_m = 0.0;  // standard deviation of each axis, in the map's unit; positive
};

struct Query {
  std::string request_id;        // of the caller; may be empty
  SessionId session;             // empty: outside of any session, and not counted
  std::string map;               // the map's name
  std::int64_t map_version = 0;  // that the answer must be in; 0: whichever it is
  std::int64_t capture_unix_ns = 0;
  std::vector<View> views;  // exactly one today
  std::optional<Gravity> gravity;
  std::optional<PosePrior> prior;
  std::optional<Strategy> requested_strategy;
  Refinement refinement = Refinement::kAuto;
  // Inlier threshold in pixels of the view's image, in [0.1, 1000]; unset: the server's.
  std::optional<double> max_error_px;
};

}  // namespace maploc
