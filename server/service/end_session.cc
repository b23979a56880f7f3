#include <spdlog/spdlog.h>

#include "proto/convert/convert.h"
#include "server/service/handlers.h"

namespace maploc {
namespace {

// Before the session ends, so that no moment is left in which it counts.
Status Discard(MapStore& store, const SessionId& id) {
  MAPLOC_ASSIGN_OR_RETURN(const Session session, store.GetSession(id));
  // A repeated discard, or an operator was first.
  if (session.revoked) return Status::Ok();
  if (session.end == SessionEnd::kOpen) return store.RevokeSession(id);
  return FailedPrecondition("SESSION_CLOSED", "session '" + id +
                                                  "' has ended and counts; an operator can take "
                                                  "it back with maploc-map revoke");
}

}  // namespace

Status HandleEndSession(const ServiceContext& context, const Call& call,
                        const v1::EndSessionRequest& request, v1::EndSessionResponse* response) {
  MAPLOC_ASSIGN_OR_RETURN(const SessionId id, SessionIdFromProto(request));
  call.facts->session = id;
  // Only then, because whoever is not restricted needs no read of the store: End itself refuses a
  // session that is not there.
  if (call.caller.is_restricted()) {
    MAPLOC_ASSIGN_OR_RETURN(const Session session, context.store->GetSession(id));
    MAPLOC_RETURN_IF_ERROR(call.caller.CheckEnd(session));
  }
  if (request.discard()) MAPLOC_RETURN_IF_ERROR(Discard(*context.store, id));
  MAPLOC_ASSIGN_OR_RETURN(const SessionSummary summary, context.sessions->End(id, call.deadline));
  spdlog::info("session {} has ended: {} of {} queries localized{}", id, summary.localized,
               summary.queries, request.discard() ? "; it does not count" : "");
  SessionSummaryToProto(summary, response);
  // The next query uses what this session taught. The end itself stands whatever becomes of this;
  // the cache tries again by itself.
  if (const Status status = context.maps->Refresh(); !status.ok()) {
    spdlog::warn("strategies are refreshed later: {}", status.ToString());
  }
  return Status::Ok();
}

}  // namespace maploc
