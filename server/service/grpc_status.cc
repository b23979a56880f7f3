#include "server/service/grpc_status.h"

#include <optional>
#include <string>

namespace maploc {
namespace {

// A full queue is a matter of a few localizations; sessions end in minutes. A request that is too
// large stays too large.
std::optional<int> RetryDelayMs(const Status& status) {
  if (status.reason() == "QUEUE_FULL") return 100;
  if (status.reason() == "TOO_MANY_SESSIONS") return 10000;
  return std::nullopt;
}

}  // namespace

grpc::Status ToGrpc(const Status& status, grpc::CallbackServerContext* context) {
  if (status.ok()) return grpc::Status::OK;
  context->AddTrailingMetadata(kReasonMetadata, status.reason());
  if (const std::optional<int> delay_ms = RetryDelayMs(status)) {
    context->AddTrailingMetadata(kRetryDelayMetadata, std::to_string(*delay_ms));
  }
  return {static_cast<grpc::StatusCode>(status.code()),
          status.message() + " (" + status.reason() + ")"};
}

}  // namespace maploc
