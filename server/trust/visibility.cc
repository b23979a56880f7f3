#include "server/trust/visibility.h"

#include <cmath>
#include <numbers>

namespace maploc {
namespace {

constexpr double kMostTurnRad = std::numbers::pi / 2.0;
constexpr double kMostScale = 5.0;

template <typename Correspondence, typename PlaceFn>
void ClearUnseen(const std::vector<Correspondence>& features, const Eigen::Vector3d& center,
                 const PlaceFn& place, std::vector<std::uint8_t>& inliers) {
  for (std::size_t i = 0; i < inliers.size(); ++i) {
    if (inliers[i] == 0) continue;
    inliers[i] = IsVisible(features[i].viewing, place(features[i]), center) ? 1 : 0;
  }
}

}  // namespace

bool IsVisible(const ViewingRange& viewing, const Eigen::Vector3d& landmark_in_map,
               const Eigen::Vector3d& camera_center_in_map) {
  if (!viewing.IsKnown()) return true;
  const Eigen::Vector3d toward_camera = camera_center_in_map - landmark_in_map;
  const double distance = toward_camera.norm();
  if (distance * kMostScale < viewing.min_distance) return false;
  if (distance > kMostScale * viewing.max_distance) return false;
  const double most = viewing.max_angle_rad + kMostTurnRad;
  return most >= std::numbers::pi ||
         toward_camera.dot(viewing.toward_cameras_in_map.cast<double>()) >=
             distance * std::cos(most);
}

RefinedPose WithoutUnseen(const PoseProblem& problem, RefinedPose pose) {
  const Eigen::Vector3d center = pose.camera_from_map.Inverse().translation;
  ClearUnseen(
      problem.points, center,
      [](const PointCorrespondence& point) { return point.position_in_map; }, pose.point_inliers);
  ClearUnseen(
      problem.lines, center,
      [](const LineCorrespondence& line) -> Eigen::Vector3d {
        return 0.5 * (line.segment_in_map.start + line.segment_in_map.end);
      },
      pose.line_inliers);
  return pose;
}

}  // namespace maploc
