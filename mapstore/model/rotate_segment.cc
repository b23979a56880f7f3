#include "mapstore/model/rotate_segment.h"

namespace maploc {
namespace {

void Rotate(const Eigen::Matrix3d& rotation, std::vector<ViewingRange>& viewing) {
  for (ViewingRange& range : viewing) {
    range.toward_cameras_in_map = rotation.cast<float>() * range.toward_cameras_in_map;
  }
}

PositionCovariance Rotated(const Eigen::Matrix3d& rotation, const PositionCovariance& upper) {
  Eigen::Matrix3d covariance;
  covariance << upper[0], upper[1], upper[2], upper[1], upper[3], upper[4], upper[2], upper[4],
      upper[5];
  const Eigen::Matrix3f turned = (rotation * covariance * rotation.transpose()).cast<float>();
  return {turned(0, 0), turned(0, 1), turned(0, 2), turned(1, 1), turned(1, 2), turned(2, 2)};
}

}  // namespace

Segment RotateSegment(const Eigen::Quaterniond& turned_from_map, Segment segment) {
  const Eigen::Matrix3d rotation = turned_from_map.toRotationMatrix();
  for (Eigen::Vector3d& center : segment.path_in_map) center = rotation * center;
  for (Eigen::Vector3d& position : segment.points.positions_in_map) position = rotation * position;
  for (LineSegment3& line : segment.lines.segments_in_map) {
    line = {rotation * line.start, rotation * line.end};
  }
  Rotate(rotation, segment.points.viewing);
  Rotate(rotation, segment.lines.viewing);
  for (PositionCovariance& covariance : segment.points.position_covariances) {
    covariance = Rotated(rotation, covariance);
  }
  return segment;
}

}  // namespace maploc
