// A made-up pinhole problem as another camera sees it: the same map, from the same place, through
// another lens, which may be turned so that the scene falls onto its rim. With noise of angle the
// answer is worth the same, whatever the lens.
#pragma once

#include <Eigen/Geometry>

#include "server/matching/pose_problem.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {

// An equidistant lens of `degrees` from rim to rim across a square image, bent a little; pixels a
// radian as asked for.
inline Camera FisheyeOf(double degrees, double px_per_rad) {
  const double half_px = 0.5 * degrees * 3.14159265358979323846 / 180.0 * px_per_rad;
  const int side_px = static_cast<int>(2.05 * half_px);
  return Camera::Create(CameraModel::kOpenCvFisheye, side_px, side_px,
                        {px_per_rad, px_per_rad, 0.5 * side_px, 0.5 * side_px, 0.004, -0.003,
                         0.0005, -0.00003})
      .value();
}

// The features of `made` as `camera` has them, its axes turned by `turn` from the pinhole's; those
// that it does not see are left out.
inline PoseProblem SeenThrough(const Camera& camera, const Eigen::Quaterniond& turn,
                               const PoseProblem& made) {
  View view{camera, {}, {}, {}};
  Segment segment;
  Matches matches;
  const auto see = [&](const Eigen::Vector2d& in_plane) {
    return camera.Project(turn * in_plane.homogeneous());
  };
  for (const PointCorrespondence& point : made.points) {
    const auto pixel = see(point.normalized);
    if (!pixel) continue;
    const int index = static_cast<int>(segment.points.positions_in_map.size());
    matches.points.push_back({index, index, static_cast<float>(point.ratio)});
    view.points.keypoints_px.push_back(pixel->cast<float>());
    segment.points.positions_in_map.push_back(point.position_in_map);
  }
  for (const LineCorrespondence& line : made.lines) {
    const auto start = see(line.normalized.start);
    const auto end = see(line.normalized.end);
    if (!start || !end) continue;
    const int index = static_cast<int>(segment.lines.segments_in_map.size());
    matches.lines.push_back({index, index, static_cast<float>(line.ratio)});
    view.lines.starts_px.push_back(start->cast<float>());
    view.lines.ends_px.push_back(end->cast<float>());
    segment.lines.segments_in_map.push_back(line.segment_in_map);
  }
  const Gravity gravity{turn * made.gravity_in_camera, made.gravity_sigma_rad};
  return BuildPoseProblem(matches, view, segment, gravity).problem;
}

// A problem that keeps only what a lens of 180 degrees shows, its features with frames: what
// benchmarks compare with the pinhole's own.
inline SyntheticProblem ThroughFisheye(SyntheticProblem made) {
  made.problem = SeenThrough(FisheyeOf(180, made.problem.focal_length_px),
                             Eigen::Quaterniond::Identity(), made.problem);
  return made;
}

// Each ray turned by N(0, sigma) about two axes across it.
inline void AddAngularNoise(double sigma_rad, Random& random, PoseProblem* problem) {
  const auto disturb = [&](Eigen::Vector2d* in_plane) {
    const Eigen::Vector3d ray = in_plane->homogeneous().normalized();
    const Eigen::Vector3d across = ray.unitOrthogonal();
    const double first = random.Gaussian(sigma_rad);
    const double second = random.Gaussian(sigma_rad);
    *in_plane = (ray + first * across + second * ray.cross(across)).hnormalized();
  };
  for (PointCorrespondence& point : problem->points) disturb(&point.normalized);
  for (LineCorrespondence& line : problem->lines) {
    disturb(&line.normalized.start);
    disturb(&line.normalized.end);
  }
}

}  // namespace maploc::testing
