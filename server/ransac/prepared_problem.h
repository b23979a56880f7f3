// A PoseProblem made ready for thousands of hypotheses: the map moved to its centroid (so that a
// map far from its origin keeps its digits in single precision), rays turned into the
// gravity-aligned frame once, scoring arrays in random order.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "mapstore/base/random.h"
#include "mapstore/model/matches.h"
#include "server/ransac/scoring.h"
#include "server/solvers/reprojection.h"

namespace maploc {

struct PreparedPoint {
  Eigen::Vector3d ray_in_camera;   // z = 1
  Eigen::Vector3d ray_in_aligned;  // the same, turned
  Eigen::Vector3d position;        // centred map
};

struct PreparedLine {
  Eigen::Vector3d plane_normal_in_camera;   // unit
  Eigen::Vector3d plane_normal_in_aligned;  // unit
  Eigen::Vector3d point;                    // centred map
  Eigen::Vector3d direction;                // unit
  bool usable = false;                      // tilt of 10 degrees or more, and a plane is seen
  bool vertical = false;                    // tilt below 10 degrees, and a plane is seen
};

struct PreparedProblem {
  PoseProblem centred;       // positions relative to `centroid`
  Eigen::Vector3d centroid;  // in the map
  Eigen::Quaterniond camera_from_aligned;
  Eigen::Matrix3d camera_from_aligned_matrix;
  std::vector<PreparedPoint> points;
  std::vector<PreparedLine> lines;
  std::vector<std::int32_t> usable_lines;      // indices into `lines`
  std::vector<std::int32_t> vertical_lines;    // indices into `lines`
  PointArrays point_arrays;                    // in random order, padded
  std::vector<std::uint32_t> place_in_arrays;  // of each point
  LineArrays line_arrays;                      // padded
};

// `random` orders the scoring arrays, so that any block of them is a random sample.
PreparedProblem PrepareProblem(const PoseProblem& problem, Random& random);

// The same pose before and after the map is moved to its centroid.
Rigid3 UncentredPose(const PreparedProblem& prepared, const PoseMatrix& camera_from_centred);

ScoringPose ToScoringPose(const PoseMatrix& pose);

}  // namespace maploc
