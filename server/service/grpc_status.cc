#include "server/service/grpc_status.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string>
#include <string_view>

#include "google/rpc/status.pb.h"
#include "mapstore/base/without_path.h"

namespace maploc {
namespace {

struct Delay {
  std::string_view reason;
  int ms;
};

// A full queue is a matter of a few localizations, another process's transaction of a second;
// sessions end in minutes; a disk waits for a person.
constexpr Delay kDelays[] = {
    {"QUEUE_FULL", 100},          {"MAP_MOVES", 100},           {"SESSION_BUSY", 100},
    {"QUERY_RUNNING", 100},       {"STORE_BUSY", 1000},         {"SHUTTING_DOWN", 1000},
    {"STATISTICS_BACKLOG", 5000}, {"TOO_MANY_SESSIONS", 10000}, {"DISK_FULL", 10000}};
constexpr int kOtherUnavailableMs = 10000;

// The path of a field with which a message starts, before ": "; empty: it is about none. In
// brackets anything may stand: "views[0].camera", "labels[the season]".
std::string FieldOf(const std::string& message) {
  std::size_t end = 0;
  while (end < message.size()) {
    const auto c = static_cast<unsigned char>(message[end]);
    if (c == '[') {
      end = std::min(message.find(']', end), message.size() - 1);
    } else if (std::isalnum(c) == 0 && c != '_' && c != '.') {
      break;
    }
    ++end;
  }
  return message.substr(end).starts_with(": ") ? message.substr(0, end) : "";
}

void AddBadRequest(const std::string& message, google::rpc::Status* details) {
  const std::string field = FieldOf(message);
  if (field.empty()) return;
  google::rpc::BadRequest request;
  google::rpc::BadRequest::FieldViolation* violation = request.add_field_violations();
  violation->set_field(field);
  violation->set_description(message.substr(field.size() + 2));
  details->add_details()->PackFrom(request);
}

// A google.rpc.Status.
std::string Details(const Status& status, const std::string& message) {
  google::rpc::Status details;
  details.set_code(static_cast<int>(status.code()));
  details.set_message(message);
  google::rpc::ErrorInfo info;
  info.set_reason(status.reason());
  info.set_domain(kErrorDomain);
  details.add_details()->PackFrom(info);
  if (status.code() == StatusCode::kInvalidArgument) AddBadRequest(message, &details);
  if (const std::optional<int> delay_ms = RetryDelayMs(status)) {
    google::rpc::RetryInfo retry;
    retry.mutable_retry_delay()->set_seconds(*delay_ms / 1000);
    retry.mutable_retry_delay()->set_nanos(*delay_ms % 1000 * 1'000'000);
    details.add_details()->PackFrom(retry);
  }
  return details.SerializeAsString();
}

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
  const std::string message = WithoutPath(status.message(), store_path);
  // The reason stands in the message too, for tools that show no trailing metadata.
  return {static_cast<grpc::StatusCode>(status.code()), message + " (" + status.reason() + ")",
          Details(status, message)};
}

Status NotParsed(const std::string& message) {
  return Status(StatusCode::kInvalidArgument, "NOT_PARSED",
                "the bytes are no " + message +
                    "; send a message of proto/maploc/v1 whose strings are UTF-8");
}

}  // namespace maploc
