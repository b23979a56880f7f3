#include "server/service/map_messages.h"

#include "proto/convert/convert.h"

namespace maploc {

void MapSummaryToProto(const MapSummary& summary, v1::Map* proto) {
  MapInfoToProto(summary.info, proto);
  proto->set_segment_count(static_cast<std::int32_t>(summary.segments));
  proto->set_point_count(summary.points);
  proto->set_line_count(summary.lines);
  proto->set_usable_line_count(summary.usable_lines);
}

void SegmentSummaryToProto(const SegmentSummary& summary, bool with_path, v1::Segment* proto) {
  proto->set_segment_id(summary.id);
  proto->set_point_count(static_cast<std::int32_t>(summary.points));
  proto->set_line_count(static_cast<std::int32_t>(summary.lines));
  proto->set_usable_line_count(static_cast<std::int32_t>(summary.usable_lines));
  SegmentKnowledgeToProto(summary.statistics, summary.decision, proto);
  if (!with_path) return;
  for (const Eigen::Vector3d& centre_in_map : summary.path_in_map) {
    for (const double coordinate : centre_in_map) proto->add_path_in_map(coordinate);
  }
}

Result<MapSummary> FindMap(const MapStore& store, const std::string& name) {
  MAPLOC_RETURN_IF_ERROR(CheckMapName(name));
  Result<MapSummary> map = store.GetMap(name);
  if (map.ok() || map.status().code() != StatusCode::kNotFound) return map;
  // The store's cure for a map without an enabled version is an operator's command, which a robot
  // cannot give.
  return NotFound("map '" + name + "'", "MAP_NOT_FOUND");
}

}  // namespace maploc
