// The two errors that everything downstream is made of, with their derivatives.
//
// Point: e = (q.x / q.z, q.y / q.z) - seen,   q = R p + t.
// Line:  e_i = m . (u_i, v_i, 1) / |(m.x, m.y)|,   m = (R s + t) x R (end - s): the signed distance
// of each seen end point to the projected (infinite) map line. The seen end points need not be the
// images of the map's.
//
// Where features have frames (pixel_frame.h), to first order and at any angle off the axis:
// Point: e = across q / (ray . q);   line: e_i = m . ray_i / |gradient_i m|.
//
// Frames: R, t is camera_from_map. Errors times the problem's focal length are pixels (matches.h),
// whatever the camera. Derivatives are with respect to (w, d) in R' = Exp(w) R, t' = t + d, at
// (w, d) = 0.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/matches.h"

namespace maploc {

using Jacobian26 = Eigen::Matrix<double, 2, 6>;

// A pose with its rotation as a matrix: what loops over features use.
struct PoseMatrix {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  PoseMatrix() = default;
  explicit PoseMatrix(const Rigid3& pose)
      : rotation(pose.rotation.toRotationMatrix()), translation(pose.translation) {}
};

// False when the point is not in front of the camera (z <= 0; with a frame 90 degrees or more off
// the ray that is seen); the outputs are then untouched.
// `jacobian` may be null.
bool PointReprojection(const PoseMatrix& camera_from_map, const PointCorrespondence& point,
                       Eigen::Vector2d* error, Jacobian26* jacobian);

// False when no part of the map segment is in front of the camera (of what is seen), or when its
// line passes through the camera's centre (no projection). `jacobian` may be null.
bool LineReprojection(const PoseMatrix& camera_from_map, const LineCorrespondence& line,
                      Eigen::Vector2d* error, Jacobian26* jacobian);

// A line whose projection is shorter than this says nothing: every image line passes through a dot.
inline constexpr double kMinProjectedLinePx = 5.0;

// Length of the projected map segment; infinite when it crosses the camera's plane (with frames: is
// seen under 90 degrees or more), 0 when it lies behind.
double ProjectedLength(const PoseMatrix& camera_from_map, const LineCorrespondence& line);

// How far away, in the direction that counts as in front; of a line the middle of its part there.
double SeenDepth(const PoseMatrix& camera_from_map, const PointCorrespondence& point);
double SeenDepth(const PoseMatrix& camera_from_map, const LineCorrespondence& line);

// Within `threshold` and in front. For a line both end points must be, and the
// projection at least `min_length` long.
bool IsPointInlier(const PoseMatrix& camera_from_map, const PointCorrespondence& point,
                   double threshold);
bool IsLineInlier(const PoseMatrix& camera_from_map, const LineCorrespondence& line,
                  double threshold, double min_length);

// The same problem in a map whose origin is `origin_in_map`: far from a map's own origin positions
// keep their digits so.
PoseProblem MovedTo(const PoseProblem& problem, const Eigen::Vector3d& origin_in_map);

struct InlierFlags {
  std::vector<std::uint8_t> points;  // one a correspondence, 0 or 1
  std::vector<std::uint8_t> lines;
  int count = 0;
};

// REQUIRES: threshold_px > 0.
InlierFlags FindInliers(const PoseProblem& problem, const Rigid3& camera_from_map,
                        double threshold_px);

}  // namespace maploc
