#include "mapstore/model/rotate_segment.h"

namespace maploc {
namespace {

void Rotate(const Eigen::Matrix3d& rotation, std::vector<ViewingRange>& viewing) {
  for (ViewingRange& range : viewing) {
    range.toward_cameras_in_map = rotation.cast<float>() * range.toward_cameras_in_map;
  }
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
  return segment;
}

}  // namespace maploc
