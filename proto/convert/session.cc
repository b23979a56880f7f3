// Session requests and summaries.
#include "maploc/v1/localization_service.pb.h"
#include "mapstore/base/name.h"
#include "proto/convert/checks.h"
#include "proto/convert/convert.h"

namespace maploc {
namespace {

Result<SessionSummary::SegmentChange> ChangeFromProto(const v1::SegmentChange& change,
                                                      const std::string& field) {
  SessionSummary::SegmentChange result;
  result.segment = change.segment_id();
  result.queries = change.query_count();
  result.localized = change.localized_count();
  MAPLOC_ASSIGN_OR_RETURN(
      result.strategy_before,
      convert::StrategyFromProto(change.strategy_before(), field + ".strategy_before"));
  MAPLOC_ASSIGN_OR_RETURN(
      result.strategy_after,
      convert::StrategyFromProto(change.strategy_after(), field + ".strategy_after"));
  return result;
}

}  // namespace

Result<SessionRequest> SessionRequestFromProto(const v1::StartSessionRequest& request) {
  MAPLOC_RETURN_IF_ERROR(convert::CheckRequiredName("map", request.map()));
  MAPLOC_RETURN_IF_ERROR(convert::CheckRequiredName("robot", request.robot()));
  MAPLOC_RETURN_IF_ERROR(CheckName("request_id", request.request_id()));
  MAPLOC_RETURN_IF_ERROR(convert::CheckMapVersion(request.map_version()));
  if (request.labels_size() > kMaxLabels) {
    return InvalidArgument("labels", "at most 32 are allowed", "TOO_MANY_LABELS");
  }
  for (const auto& [key, value] : request.labels()) {
    if (key.empty()) return InvalidArgument("labels", "one has an empty key", "REQUIRED");
    MAPLOC_RETURN_IF_ERROR(CheckName("labels", key));
    MAPLOC_RETURN_IF_ERROR(CheckName(LabelField(key), value));
  }
  return SessionRequest{.map = request.map(),
                        .robot = request.robot(),
                        .labels = {request.labels().begin(), request.labels().end()},
                        .request_id = request.request_id(),
                        .map_version = request.map_version()};
}

Result<SessionId> SessionIdFromProto(const v1::EndSessionRequest& request) {
  MAPLOC_RETURN_IF_ERROR(convert::CheckRequiredName("session_id", request.session_id()));
  return request.session_id();
}

void SessionSummaryToProto(const SessionSummary& summary, v1::EndSessionResponse* response) {
  response->Clear();
  response->set_end(static_cast<v1::SessionEnd>(summary.end));
  response->set_query_count(summary.queries);
  response->set_localized_count(summary.localized);
  for (const SessionSummary::SegmentChange& change : summary.segments) {
    v1::SegmentChange* proto = response->add_segments();
    proto->set_segment_id(change.segment);
    proto->set_query_count(change.queries);
    proto->set_localized_count(change.localized);
    proto->set_strategy_before(convert::StrategyToProto(change.strategy_before));
    proto->set_strategy_after(convert::StrategyToProto(change.strategy_after));
  }
}

Result<SessionSummary> SessionSummaryFromProto(const v1::EndSessionResponse& response,
                                               const SessionId& session) {
  // 0 would be an open session, which has no summary.
  if (response.end() != v1::SESSION_END_BY_ROBOT && response.end() != v1::SESSION_END_IDLE) {
    return convert::UnknownEnum("end", response.end());
  }
  SessionSummary summary;
  summary.session = session;
  summary.end = static_cast<SessionEnd>(response.end());
  summary.queries = response.query_count();
  summary.localized = response.localized_count();
  for (int i = 0; i < response.segments_size(); ++i) {
    MAPLOC_ASSIGN_OR_RETURN(const SessionSummary::SegmentChange change,
                            ChangeFromProto(response.segments(i), convert::At("segments", i)));
    summary.segments.push_back(change);
  }
  return summary;
}

}  // namespace maploc
