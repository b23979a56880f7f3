// A call that is over, for the recorder of queries. Internal to server/service.
#pragma once

#include <cstdint>

#include "server/service/request_log.h"

namespace maploc::v1 {
class LocalizeRequest;
class LocalizeResponse;
}  // namespace maploc::v1

namespace maploc {

class QueryRecorder;

// Takes the messages along.
void RecordQuery(QueryRecorder& recorder, const FinishedRequest& call, std::int64_t now_unix_ns,
                 v1::LocalizeRequest& request, v1::LocalizeResponse& response);

// Other calls are no queries.
template <typename Request, typename Response>
void RecordQuery(QueryRecorder&, const FinishedRequest&, std::int64_t, Request&, Response&) {}

}  // namespace maploc
