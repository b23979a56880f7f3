#include "server/service/handlers.h"
#include "server/service/map_messages.h"

namespace maploc {

Status HandleGetSegment(const ServiceContext& context, const Call& call,
                        const v1::GetSegmentRequest& request, v1::GetSegmentResponse* response) {
  MAPLOC_RETURN_IF_ERROR(call.caller.CheckRead(request.map()));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, FindMap(*context.store, request.map()));
  call.facts->map = map.info.key.name;
  call.facts->version = map.info.key.version;
  const Result<SegmentSummary> segment =
      context.store->GetSegment(map.info.key, request.segment_id());
  // In the request's words: the store's message names a version, the request does not.
  if (!segment.ok() && segment.status().code() == StatusCode::kNotFound) {
    return NotFound(
        "segment " + std::to_string(request.segment_id()) + " of map '" + request.map() + "'",
        "SEGMENT_NOT_FOUND");
  }
  if (!segment.ok()) return segment.status();
  SegmentSummaryToProto(*segment, /*with_path=*/true, response->mutable_segment());
  return Status::Ok();
}

}  // namespace maploc
