#include "mapstore/importers/landmark_views.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Eigenvalues>

#include "mapstore/importers/point_geometry.h"

namespace maploc {
namespace {

PositionCovariance Pack(const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3f m = covariance.cast<float>();
  if (!m.allFinite()) return {};  // distances beyond what a float can say
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
}

// Of the frame's pixel by the point's position; nullopt where the frame cannot see it.
std::optional<Eigen::Matrix<double, 2, 3>> PixelJacobian(const KeyFrame& frame,
                                                         const Eigen::Vector3d& position_in_map) {
  const Eigen::Vector3d in_camera = frame.camera_from_map * position_in_map;
  if (!frame.camera.IsWide()) {
    if (!(in_camera.z() > 0)) return std::nullopt;
    return frame.camera.MeanFocalLengthPx() *
           NormalizedJacobian(frame.camera_from_map, position_in_map);
  }
  const auto pixel = frame.camera.Project(in_camera);
  const auto seen = pixel ? frame.camera.Frame(*pixel) : std::nullopt;
  if (!seen) return std::nullopt;
  return seen->across / in_camera.norm() * frame.camera_from_map.rotation.toRotationMatrix();
}

}  // namespace

ViewingRange ViewingFromFrames(const Eigen::Vector3d& position_in_map,
                               std::span<const KeyFrame> frames,
                               std::span<const std::int32_t> seen_by) {
  std::vector<Eigen::Vector3d> centers;
  for (const std::int32_t frame : seen_by) {
    centers.push_back(frames[static_cast<std::size_t>(frame)].CenterInMap());
  }
  return MakeViewingRange(position_in_map, centers);
}

PositionCovariance CovarianceFromFrames(const Eigen::Vector3d& position_in_map,
                                        std::span<const KeyFrame> frames,
                                        std::span<const std::int32_t> seen_by) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double max_distance2 = 0;
  for (const std::int32_t index : seen_by) {
    const KeyFrame& frame = frames[static_cast<std::size_t>(index)];
    const auto jacobian = PixelJacobian(frame, position_in_map);
    if (!jacobian) continue;
    information += jacobian->transpose() * *jacobian;
    max_distance2 =
        std::max(max_distance2, (frame.camera_from_map * position_in_map).squaredNorm());
  }
  if (!(max_distance2 > 0) || !information.allFinite()) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
  const Eigen::Vector3d variances = solver.eigenvalues().unaryExpr([&](double determined) {
    return determined * max_distance2 > 1 ? 1 / determined : max_distance2;
  });
  const Eigen::Matrix3d& axes = solver.eigenvectors();
  return Pack(axes * variances.asDiagonal() * axes.transpose());
}

}  // namespace maploc
