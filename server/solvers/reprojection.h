// The two errors that everything downstream is made of, with their derivatives.
//
// Point: e = (q.x / q.z, q.y / q.z) - seen,   q = R p + t.
// Line:  e_i = m . (u_i, v_i, 1) / |(m.x, m.y)|,   m = (R s + t) x R (end - s): the signed distance
// of
//        each seen end point to the projected (infinite) map line. The seen end points need not be
//        the images of the map's.
//
// Frames: R, t is camera_from_map; seen coordinates lie in the camera's plane z = 1, so an error
// times the focal length is in pixels. Derivatives are with respect to (w, d) in
// R' = Exp(w) R, t' = t + d, at (w, d) = 0.
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

// False when the point is not in front of the camera (z <= 0); the outputs are then untouched.
// `jacobian` may be null.
bool PointReprojection(const PoseMatrix& camera_from_map, const PointCorrespondence& point,
                       Eigen::Vector2d* error, Jacobian26* jacobian);

// False when no part of the map segment is in front of the camera, or when its line passes through
// the camera's centre (no projection). `jacobian` may be null.
bool LineReprojection(const PoseMatrix& camera_from_map, const LineCorrespondence& line,
                      Eigen::Vector2d* error, Jacobian26* jacobian);

// A line whose projection is shorter than this says nothing: every image line passes through a dot.
inline constexpr double kMinProjectedLinePx = 5.0;

// Length of the projected map segment in the plane z = 1; infinite when it crosses the camera's
// plane, 0 when it lies behind.
double ProjectedLength(const PoseMatrix& camera_from_map, const LineSegment3& segment_in_map);

// Within `threshold` (plane z = 1) and in front. For a line both end points must be, and the
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
