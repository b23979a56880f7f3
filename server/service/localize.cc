#include <optional>
#include <string>
#include <utility>

#include "proto/convert/convert.h"
#include "server/pipeline/localizer.h"
#include "server/service/handlers.h"
#include "server/service/payload_hash.h"
#include "server/sessions/map_version.h"

namespace maploc {
namespace {

double MillisecondsSince(std::chrono::steady_clock::time_point start, const Clock& clock) {
  return std::chrono::duration<double, std::milli>(clock.SteadyNow() - start).count();
}

// Within a session the map may be left out. Another one must not pass, or the robot would take a
// pose in the session's map for one in the map that it named.
Status CheckMap(const Query& query, const Session& session) {
  if (query.map.empty() || query.map == session.map.name) return Status::Ok();
  return InvalidArgument("map", "the session is on map '" + session.map.name + "'", "MAP_MISMATCH");
}

Observation Observe(const Localization& localization, const std::string& counted_as,
                    const Clock& clock) {
  Observation observation;
  observation.segment = localization.segment;
  observation.outcome = localization.outcome;
  observation.evidence = localization.evidence;
  observation.total_ms = localization.times.total_ms;
  observation.time_unix_ns = clock.NowUnixNanos();
  observation.counted_as = counted_as;
  return observation;
}

Result<MapCache::Snapshot> MapOf(const ServiceContext& context, const Query& query,
                                 const std::optional<SessionManager::Lease>& lease) {
  Result<MapCache::Snapshot> map =
      // A session stays on its version when another one is enabled, because its observations are of
      // that version's segments.
      lease ? context.maps->Get(lease->session().map) : context.maps->Enabled(query.map);
  if (!map.ok()) return map;
  MAPLOC_RETURN_IF_ERROR(RequireMapVersion((*map)->info.key, query.map_version));
  return map;
}

// A version that was deleted while it was open has segments no more: then the one in its place.
Result<Localization> LocalizeIn(const ServiceContext& context, const Call& call, const Query& query,
                                const std::optional<SessionManager::Lease>& lease,
                                MapCache::Snapshot map) {
  Result<Localization> answer =
      Localize(query, *map, context.localizer, call.deadline, call.cancelled);
  if (answer.status().reason() != kMapMoves) return answer;
  MAPLOC_RETURN_IF_ERROR(context.maps->Refresh());
  MAPLOC_ASSIGN_OR_RETURN(map, MapOf(context, query, lease));
  return Localize(query, *map, context.localizer, call.deadline, call.cancelled);
}

void TellQuery(const Query& query, RequestFacts& facts) {
  facts.request_id = query.request_id;
  facts.session = query.session;
  facts.map = query.map;
}

void TellSession(const Session& session, RequestFacts& facts) {
  facts.robot = session.robot;
  facts.map = session.map.name;
  facts.version = session.map.version;
}

void TellAnswer(const Localization& answer, RequestFacts& facts) {
  facts.version = answer.map.version;
  facts.outcome = answer.outcome;
  facts.times = answer.times;
}

// Nullopt: outside of any session. The lease keeps the session open until the observation is
// recorded.
Result<std::optional<SessionManager::Lease>> Enter(const ServiceContext& context, const Call& call,
                                                   const Query& query) {
  std::optional<SessionManager::Lease> lease;
  if (query.session.empty()) {
    MAPLOC_RETURN_IF_ERROR(call.caller.CheckLocalize(query.map));
    return lease;
  }
  MAPLOC_ASSIGN_OR_RETURN(SessionManager::Lease entered, context.sessions->Enter(query.session));
  lease.emplace(std::move(entered));
  MAPLOC_RETURN_IF_ERROR(call.caller.CheckLocalizeIn(lease->session()));
  // Told after the check: a caller that is refused there is not the session's robot.
  TellSession(lease->session(), *call.facts);
  MAPLOC_RETURN_IF_ERROR(CheckMap(query, lease->session()));
  return lease;
}

// A query that must not count twice; without values where it may be sent as often as one likes.
struct Counted {
  AnsweredQueries::Turn turn;
  std::string as;  // Observation::counted_as
};

Result<Counted> CountOnce(const ServiceContext& context, const v1::LocalizeRequest& request) {
  if (request.session_id().empty() || request.request_id().empty()) return Counted();
  const std::uint64_t payload = PayloadHash(request);
  MAPLOC_ASSIGN_OR_RETURN(
      AnsweredQueries::Turn turn,
      context.answered->Begin(request.session_id(), request.request_id(), payload));
  // With the payload, so that a robot that numbers its queries anew loses none.
  return Counted{std::move(turn), request.request_id() + '#' + std::to_string(payload)};
}

}  // namespace

Status HandleLocalize(const ServiceContext& context, const Call& call,
                      const v1::LocalizeRequest& request, v1::LocalizeResponse* response) {
  const auto start = context.clock->SteadyNow();
  // Maps in memory would answer on for a store that is gone, and statistics would go nowhere.
  MAPLOC_RETURN_IF_ERROR(context.store->CheckIdentity());
  MAPLOC_ASSIGN_OR_RETURN(const Query query, QueryFromProto(request));
  TellQuery(query, *call.facts);
  const double convert_ms = MillisecondsSince(start, *context.clock);
  // Before the turn: turns are kept by session, and made-up ids would fill their memory.
  MAPLOC_ASSIGN_OR_RETURN(std::optional<SessionManager::Lease> lease, Enter(context, call, query));
  MAPLOC_ASSIGN_OR_RETURN(Counted counted, CountOnce(context, request));
  if (counted.turn.repeated() != nullptr) {
    const Localization& repeated = *counted.turn.repeated();
    TellAnswer(repeated, *call.facts);
    call.facts->is_repeat = true;
    // The first answer, also where another version is enabled by now: it is the one that counts.
    LocalizationToProto(query, repeated, request.include_matches(), response);
    return Status::Ok();
  }
  MAPLOC_ASSIGN_OR_RETURN(MapCache::Snapshot map, MapOf(context, query, lease));
  const double load_ms = MillisecondsSince(start, *context.clock) - convert_ms;
  MAPLOC_ASSIGN_OR_RETURN(Localization answer,
                          LocalizeIn(context, call, query, lease, std::move(map)));
  answer.times.convert_ms = convert_ms;
  // The wire has no field for the loading of a map, which comes before the retrieval.
  answer.times.retrieval_ms += load_ms;
  answer.times.total_ms = MillisecondsSince(start, *context.clock);
  TellAnswer(answer, *call.facts);
  // Before the record, which may fail: the work was done all the same.
  context.metrics->CountAnswer(answer);
  if (lease) MAPLOC_RETURN_IF_ERROR(lease->Record(Observe(answer, counted.as, *context.clock)));
  LocalizationToProto(query, answer, request.include_matches(), response);
  // A repeat has the same payload, so nobody can ask for them later.
  if (!request.include_matches()) answer.matches = {};
  counted.turn.Keep(std::move(answer));
  return Status::Ok();
}

}  // namespace maploc
