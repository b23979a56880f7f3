#include "mapstore/model/viewing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

namespace maploc {
namespace {

// Accurate near 0 and near pi, where the arc cosine is not.
double AngleBetweenUnits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// The mean direction, or the first one where the others cancel it out.
void SetCone(const std::vector<Eigen::Vector3d>& directions, ViewingRange& range) {
  constexpr double kMinMeanLength = 1e-6;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& direction : directions) sum += direction;
  if (!(sum.norm() > kMinMeanLength * static_cast<double>(directions.size()))) {
    range.toward_cameras_in_map = directions.front().cast<float>();
    range.max_angle_rad = std::numbers::pi_v<float>;
    return;
  }
  const Eigen::Vector3d mean = sum.normalized();
  double angle = 0;
  for (const Eigen::Vector3d& direction : directions) {
    angle = std::max(angle, AngleBetweenUnits(mean, direction));
  }
  range.toward_cameras_in_map = mean.cast<float>();
  range.max_angle_rad = static_cast<float>(angle);
}

}  // namespace

ViewingRange MakeViewingRange(const Eigen::Vector3d& position_in_map,
                              std::span<const Eigen::Vector3d> camera_centers_in_map) {
  std::vector<Eigen::Vector3d> directions;
  double nearest = std::numeric_limits<double>::max();
  double farthest = 0;
  for (const Eigen::Vector3d& center : camera_centers_in_map) {
    const Eigen::Vector3d toward = center - position_in_map;
    const double distance = toward.stableNorm();
    // A camera at the landmark itself gives no direction, and distances are stored as float32.
    if (!(distance > 0 && distance <= std::numeric_limits<float>::max())) continue;
    directions.push_back(toward.stableNormalized());
    nearest = std::min(nearest, distance);
    farthest = std::max(farthest, distance);
  }
  if (directions.empty()) return {};
  ViewingRange range;
  SetCone(directions, range);
  range.min_distance = static_cast<float>(nearest);
  range.max_distance = static_cast<float>(farthest);
  return range;
}

}  // namespace maploc
