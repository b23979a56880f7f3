#include <spdlog/spdlog.h>

#include "proto/convert/convert.h"
#include "server/service/handlers.h"

namespace maploc {

Status HandleEndSession(const ServiceContext& context, const Call& call,
                        const v1::EndSessionRequest& request, v1::EndSessionResponse* response) {
  MAPLOC_ASSIGN_OR_RETURN(const SessionId id, SessionIdFromProto(request));
  MAPLOC_ASSIGN_OR_RETURN(const SessionSummary summary, context.sessions->End(id, call.deadline));
  spdlog::info("session {} has ended: {} of {} queries localized", id, summary.localized,
               summary.queries);
  SessionSummaryToProto(summary, response);
  // The next query uses what this session taught. The end itself stands whatever becomes of this;
  // the cache tries again by itself.
  if (const Status status = context.maps->Refresh(); !status.ok()) {
    spdlog::warn("strategies are refreshed later: {}", status.ToString());
  }
  return Status::Ok();
}

}  // namespace maploc
