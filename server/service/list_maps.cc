#include "server/service/handlers.h"
#include "server/service/map_messages.h"

namespace maploc {

Status HandleListMaps(const ServiceContext& context, const Call& call, const v1::ListMapsRequest&,
                      v1::ListMapsResponse* response) {
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<MapSummary> maps, context.store->ListMaps());
  for (const MapSummary& map : maps) {
    // Left out and not refused: a token tells nobody that other maps exist.
    if (call.caller.MayRead(map.info.key.name)) MapSummaryToProto(map, response->add_maps());
  }
  return Status::Ok();
}

}  // namespace maploc
