#include "tests/experiments/methods/epnp.h"

#include <algorithm>
#include <vector>

#include "tests/experiments/methods/opencv_pose.h"
#include "tests/experiments/methods/simple_ransac.h"

namespace maploc::experiments {

int DrawAndSolveEpnp(const PreparedProblem& problem, Random& random, PoseMatrix* camera_from_map) {
  const std::uint32_t size = static_cast<std::uint32_t>(problem.points.size());
  const int count = static_cast<int>(std::min<std::uint32_t>(size, kEpnpSample));
  if (count < kEpnpLeast) return 0;
  std::uint32_t indices[kEpnpSample];
  DrawDistinct(size, count, random, indices);
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> seen;
  for (int i = 0; i < count; ++i) {
    const PreparedPoint& point = problem.points[indices[i]];
    points.emplace_back(point.position.x(), point.position.y(), point.position.z());
    seen.emplace_back(point.ray_in_camera.x(), point.ray_in_camera.y());
  }
  cv::Mat turn, translation;
  try {
    if (!cv::solvePnP(points, seen, cv::Matx33d::eye(), cv::noArray(), turn, translation, false,
                      cv::SOLVEPNP_EPNP)) {
      return 0;
    }
  } catch (const cv::Exception&) {
    return 0;
  }
  const PoseMatrix pose(ToRigid3(turn, translation));
  if (!pose.rotation.allFinite() || !pose.translation.allFinite()) return 0;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d in_camera =
        pose.rotation * problem.points[indices[i]].position + pose.translation;
    if (in_camera.z() <= 0) return 0;
  }
  *camera_from_map = pose;
  return 1;
}

}  // namespace maploc::experiments
