#include "server/service/grpc_status.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>

#include "mapstore/base/without_path.h"

namespace maploc {
namespace {

struct Delay {
  std::string_view reason;
  int ms;
};

// A full queue is a matter of a few localizations, another process's transaction of a second;
// sessions end in minutes; a disk waits for a person.
constexpr Delay kDelays[] = {{"QUEUE_FULL", 100},          {"MAP_MOVES", 100},
                             {"SESSION_BUSY", 100},        {"STORE_BUSY", 1000},
                             {"SHUTTING_DOWN", 1000},      {"STATISTICS_BACKLOG", 5000},
                             {"TOO_MANY_SESSIONS", 10000}, {"DISK_FULL", 10000}};
constexpr int kOtherUnavailableMs = 10000;

}  // namespace

std::optional<int> RetryDelayMs(const Status& status) {
  const auto* const found = std::ranges::find(kDelays, status.reason(), &Delay::reason);
  if (found != std::end(kDelays)) return found->ms;
  // A message that is too large is RESOURCE_EXHAUSTED too, and stays too large.
  if (status.code() == StatusCode::kUnavailable) return kOtherUnavailableMs;
  return std::nullopt;
}

grpc::Status ToGrpc(const Status& status, const std::string& store_path,
                    grpc::CallbackServerContext* context) {
  if (status.ok()) return grpc::Status::OK;
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
