// Maps and segments as MapService tells them.
#include "maploc/v1/map_service.pb.h"
#include "proto/convert/checks.h"
#include "proto/convert/convert.h"

namespace maploc {

Status CheckMapName(const std::string& name) { return convert::CheckRequiredName("map", name); }

void MapInfoToProto(const MapInfo& info, v1::Map* proto) {
  proto->set_name(info.key.name);
  proto->set_version(info.key.version);
  proto->set_metric(info.metric);
  Similarity3ToProto(info.map_from_source, proto->mutable_map_from_source());
  DescriptorKindToProto(info.point_descriptor, proto->mutable_point_descriptor_kind());
  DescriptorKindToProto(info.line_descriptor, proto->mutable_line_descriptor_kind());
}

Result<MapInfo> MapInfoFromProto(const v1::Map& map) {
  MapInfo info;
  info.key = {map.name(), map.version()};
  info.metric = map.metric();
  MAPLOC_ASSIGN_OR_RETURN(info.map_from_source,
                          Similarity3FromProto(map.map_from_source(), "map.map_from_source"));
  MAPLOC_ASSIGN_OR_RETURN(
      info.point_descriptor,
      DescriptorKindFromProto(map.point_descriptor_kind(), "map.point_descriptor_kind"));
  MAPLOC_ASSIGN_OR_RETURN(
      info.line_descriptor,
      DescriptorKindFromProto(map.line_descriptor_kind(), "map.line_descriptor_kind"));
  return info;
}

void SegmentKnowledgeToProto(const SegmentStatistics& statistics, const StrategyDecision& decision,
                             v1::Segment* proto) {
  proto->set_strategy(convert::StrategyToProto(decision.strategy));
  proto->set_strategy_source(static_cast<v1::StrategySource>(decision.source));
  if (const auto ratio = statistics.PointInlierRatio()) proto->set_point_inlier_ratio(*ratio);
  if (const auto ratio = statistics.LineInlierRatio()) proto->set_line_inlier_ratio(*ratio);
  proto->set_session_count(statistics.sessions);
  proto->set_query_count(statistics.queries);
  proto->set_localized_count(statistics.localized);
}

}  // namespace maploc
