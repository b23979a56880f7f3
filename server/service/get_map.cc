#include "server/service/handlers.h"
#include "server/service/map_messages.h"

namespace maploc {

Status HandleGetMap(const ServiceContext& context, const Call& call,
                    const v1::GetMapRequest& request, v1::GetMapResponse* response) {
  MAPLOC_RETURN_IF_ERROR(call.caller.CheckRead(request.map()));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, FindMap(*context.store, request.map()));
  call.facts->map = map.info.key.name;
  call.facts->version = map.info.key.version;
  MapSummaryToProto(map, response->mutable_map());
  return Status::Ok();
}

}  // namespace maploc
