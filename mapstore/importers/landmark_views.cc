#include "mapstore/importers/landmark_views.h"

#include <vector>

namespace maploc {

ViewingRange ViewingFromFrames(const Eigen::Vector3d& position_in_map,
                               std::span<const KeyFrame> frames,
                               std::span<const std::int32_t> seen_by) {
  std::vector<Eigen::Vector3d> centers;
  for (const std::int32_t frame : seen_by) {
    centers.push_back(frames[static_cast<std::size_t>(frame)].CenterInMap());
  }
  return MakeViewingRange(position_in_map, centers);
}

}  // namespace maploc
