// A PoseProblem made ready for thousands of hypotheses: the map moved to its centroid (so that a
// map far from its origin keeps its digits in single precision), rays turned into the
// gravity-aligned frame once, scoring arrays in random order.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "mapstore/base/random.h"
#include "mapstore/model/matches.h"
#include "server/ransac/scoring.h"
#include "server/solvers/aligned.h"
#include "server/solvers/reprojection.h"

namespace maploc {

struct PreparedPoint {
  Eigen::Vector3d ray_in_camera;   // z = 1; of a frame unit
  Eigen::Vector3d ray_in_aligned;  // the same, turned
  Eigen::Vector3d position;        // centred map
  double scale = 0.0;              // of a frame: image length a radian; 0: a plane z = 1
};

struct PreparedLine {
  Eigen::Vector3d plane_normal_in_camera;   // unit
  Eigen::Vector3d plane_normal_in_aligned;  // unit
  Eigen::Vector3d point;                    // centred map
  Eigen::Vector3d direction;                // unit
  bool usable = false;                      // tilt of 10 degrees or more, and a plane is seen
  bool vertical = false;                    // tilt below 10 degrees, and a plane is seen
};

// Where features stand in the scoring arrays.
struct Places {
  std::vector<std::uint32_t> of_feature;  // feature -> place
  std::vector<std::uint32_t> feature_at;  // place -> feature
};

struct PreparedProblem {
  PoseProblem centred;       // positions relative to `centroid`
  Eigen::Vector3d centroid;  // in the map
  Eigen::Matrix3d camera_from_aligned_matrix;
  std::vector<PreparedPoint> points;
  std::vector<PreparedLine> lines;
  // Indices for drawing, the surest match first (smallest ratio), equals in random order.
  std::vector<std::uint32_t> drawn_points;    // into `points`
  std::vector<std::uint32_t> usable_lines;    // into `lines`
  std::vector<std::uint32_t> vertical_lines;  // into `lines`
  bool has_quality = false;                   // some ratios differ: the orders mean something
  // For scoring, in random order and padded, so that any block of them is a random sample.
  PointArrays point_arrays;
  LineArrays line_arrays;
  Places point_places;
  Places line_places;
};

// `random` orders the scoring arrays, and equals among the matches to draw.
PreparedProblem PrepareProblem(const PoseProblem& problem, Random& random);

// The same pose before and after the map is moved to its centroid.
Rigid3 UncentredPose(const PreparedProblem& prepared, const PoseMatrix& camera_from_centred);

// Turned from the aligned frame into the camera's.
PoseMatrix CameraFromCentred(const PreparedProblem& prepared,
                             const AlignedPose& aligned_from_centred);

ScoringPose ToScoringPose(const PoseMatrix& pose);

}  // namespace maploc
