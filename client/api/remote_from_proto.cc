#include "client/api/remote_from_proto.h"

#include <cmath>

#include "maploc/v1/map_service.pb.h"
#include "proto/convert/convert.h"

namespace maploc {
namespace {

// Not INVALID_ARGUMENT: the caller has done nothing wrong.
Status Broken(const Status& status) {
  return Internal("the server's answer breaks its contract: " + status.message());
}

Status CheckStrategy(const v1::Segment& segment) {
  if (segment.strategy() < v1::STRATEGY_1P1L || segment.strategy() > v1::STRATEGY_P3P) {
    return InvalidArgument("segment.strategy", "is not one that this client knows");
  }
  if (segment.strategy_source() < v1::STRATEGY_SOURCE_DEFAULT ||
      segment.strategy_source() > v1::STRATEGY_SOURCE_REQUESTED) {
    return InvalidArgument("segment.strategy_source", "is not one that this client knows");
  }
  return Status::Ok();
}

// An unset ratio reads as 0.
Status CheckRatio(const char* field, double ratio) {
  if (ratio >= 0.0 && ratio <= 1.0) return Status::Ok();
  return InvalidArgument(field, "must be in [0, 1]");
}

Status CheckPath(const v1::Segment& segment) {
  const std::string field = "segment.path_in_map";
  if (segment.path_in_map_size() % 3 != 0) {
    return InvalidArgument(field, "is not a multiple of 3 numbers");
  }
  for (int i = 0; i < segment.path_in_map_size(); ++i) {
    if (std::isfinite(segment.path_in_map(i))) continue;
    return InvalidArgument(field + "[" + std::to_string(i) + "]", "must be finite");
  }
  return Status::Ok();
}

Status CheckSegment(const v1::Segment& segment) {
  MAPLOC_RETURN_IF_ERROR(CheckStrategy(segment));
  MAPLOC_RETURN_IF_ERROR(CheckRatio("segment.point_inlier_ratio", segment.point_inlier_ratio()));
  MAPLOC_RETURN_IF_ERROR(CheckRatio("segment.line_inlier_ratio", segment.line_inlier_ratio()));
  return CheckPath(segment);
}

}  // namespace

Result<RemoteMap> RemoteMapFromProto(const v1::Map& map) {
  Result<MapInfo> info = MapInfoFromProto(map);
  if (!info.ok()) return Broken(info.status());
  RemoteMap remote;
  remote.info = *std::move(info);
  remote.segments = map.segment_count();
  remote.points = map.point_count();
  remote.lines = map.line_count();
  remote.usable_lines = map.usable_line_count();
  return remote;
}

Result<RemoteSegment> RemoteSegmentFromProto(const v1::Segment& segment) {
  if (const Status checked = CheckSegment(segment); !checked.ok()) return Broken(checked);
  RemoteSegment remote;
  remote.id = segment.segment_id();
  remote.points = segment.point_count();
  remote.lines = segment.line_count();
  remote.usable_lines = segment.usable_line_count();
  // The numbers of both enums are the wire's (mapstore/model/strategy.h).
  remote.decision.strategy = static_cast<Strategy>(segment.strategy());
  remote.decision.source = static_cast<StrategySource>(segment.strategy_source());
  if (segment.has_point_inlier_ratio()) remote.point_inlier_ratio = segment.point_inlier_ratio();
  if (segment.has_line_inlier_ratio()) remote.line_inlier_ratio = segment.line_inlier_ratio();
  remote.sessions = segment.session_count();
  remote.queries = segment.query_count();
  remote.localized = segment.localized_count();
  for (int i = 0; i < segment.path_in_map_size(); i += 3) {
    remote.path_in_map.emplace_back(segment.path_in_map(i), segment.path_in_map(i + 1),
                                    segment.path_in_map(i + 2));
  }
  return remote;
}

}  // namespace maploc
