#include <spdlog/spdlog.h>

#include "proto/convert/convert.h"
#include "server/service/handlers.h"

namespace maploc {

Status HandleStartSession(const ServiceContext& context, const Call& call,
                          const v1::StartSessionRequest& request,
                          v1::StartSessionResponse* response) {
  MAPLOC_ASSIGN_OR_RETURN(SessionRequest wanted, SessionRequestFromProto(request));
  call.facts->request_id = wanted.request_id;
  call.facts->robot = wanted.robot;
  call.facts->map = wanted.map;
  // Before the map is looked for: a refusal does not tell whether it exists.
  MAPLOC_RETURN_IF_ERROR(call.caller.CheckStart(wanted.map, wanted.robot));
  // In memory before the first query, which then does not pay for the loading.
  MAPLOC_ASSIGN_OR_RETURN(const MapCache::Snapshot map, context.maps->Enabled(wanted.map));
  MAPLOC_ASSIGN_OR_RETURN(
      const Session session,
      context.sessions->Start({map->info.key, wanted.robot, std::move(wanted.labels),
                               wanted.request_id, wanted.map_version}));
  spdlog::info("session {} of robot '{}' starts on map '{}' version {}", session.id, session.robot,
               session.map.name, session.map.version);
  call.facts->session = session.id;
  call.facts->version = session.map.version;
  response->set_session_id(session.id);
  response->set_map_version(session.map.version);
  return Status::Ok();
}

}  // namespace maploc
