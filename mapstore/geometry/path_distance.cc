#include "mapstore/geometry/path_distance.h"

#include <algorithm>

namespace maploc {
namespace {

double SquaredDistanceToSegment(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                                const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double squared_length = along.squaredNorm();
  const double t =
      squared_length > 0.0 ? std::clamp(along.dot(point - a) / squared_length, 0.0, 1.0) : 0.0;
  return (a + t * along - point).squaredNorm();
}

}  // namespace

double DistanceToPath(const Eigen::Vector3d& point, std::span<const Eigen::Vector3d> path) {
  if (path.empty()) return std::numeric_limits<double>::infinity();
  double nearest = (path.front() - point).squaredNorm();
  for (std::size_t i = 1; i < path.size(); ++i) {
    nearest = std::min(nearest, SquaredDistanceToSegment(point, path[i - 1], path[i]));
  }
  return std::sqrt(nearest);
}

}  // namespace maploc
