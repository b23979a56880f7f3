#include "server/service/record_query.h"

#include <utility>

#include "maploc/recording/v1/recording.pb.h"
#include "server/recorder/query_recorder.h"

namespace maploc {

void RecordQuery(QueryRecorder& recorder, const FinishedRequest& call, std::int64_t now_unix_ns,
                 v1::LocalizeRequest& request, v1::LocalizeResponse& response) {
  recording::v1::RecordedQuery query;
  *query.mutable_request() = std::move(request);
  if (call.status.ok()) {
    *query.mutable_answer() = std::move(response);
  } else {
    recording::v1::Refusal* const refusal = query.mutable_refusal();
    refusal->set_code(static_cast<int>(call.status.code()));
    refusal->set_reason(call.status.reason());
    refusal->set_message(call.status.message());
  }
  query.set_robot(call.facts.robot);
  query.set_map(call.facts.map);
  query.set_map_version(call.facts.version);
  query.set_answered_unix_nanos(now_unix_ns);
  query.set_total_ms(call.total_ms);
  recorder.Offer(std::move(query));
}

}  // namespace maploc
