#include "server/service/handlers.h"
#include "server/service/map_messages.h"

namespace maploc {

Status HandleListSegments(const ServiceContext& context, const Call& call,
                          const v1::ListSegmentsRequest& request,
                          v1::ListSegmentsResponse* response) {
  MAPLOC_RETURN_IF_ERROR(call.caller.CheckRead(request.map()));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, FindMap(*context.store, request.map()));
  call.facts->map = map.info.key.name;
  call.facts->version = map.info.key.version;
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<SegmentSummary> segments,
                          context.store->ListSegments(map.info.key));
  for (const SegmentSummary& segment : segments) {
    // The paths grow with the number of photos; an overview of a large map stays small without
    // them.
    SegmentSummaryToProto(segment, /*with_path=*/false, response->add_segments());
  }
  return Status::Ok();
}

}  // namespace maploc
