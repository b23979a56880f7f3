#include "server/service/grpc_status.h"

#include <optional>
#include <string>

#include <spdlog/spdlog.h>

#include "mapstore/base/without_path.h"

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

grpc::Status ToGrpc(const Status& status, const std::string& store_path,
                    grpc::CallbackServerContext* context) {
  if (status.ok()) return grpc::Status::OK;
  if (status.code() == StatusCode::kInternal || status.code() == StatusCode::kDataLoss) {
    spdlog::error("a call has failed: {}", status.ToString());
  }
  context->AddTrailingMetadata(kReasonMetadata, status.reason());
  if (const std::optional<int> delay_ms = RetryDelayMs(status)) {
    context->AddTrailingMetadata(kRetryDelayMetadata, std::to_string(*delay_ms));
  }
  return {static_cast<grpc::StatusCode>(status.code()),
          WithoutPath(status.message(), store_path) + " (" + status.reason() + ")"};
}

Status NotParsed(const std::string& message) {
  return Status(StatusCode::kInvalidArgument, "NOT_PARSED",
                "the bytes are no " + message +
                    "; send a message of proto/maploc/v1 whose strings are UTF-8");
}

}  // namespace maploc
