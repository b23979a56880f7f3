#include "mapstore/base/status.h"

namespace maploc {
namespace {

Status Make(StatusCode code, std::string_view reason, std::string message) {
  return Status(code, std::string(reason), std::move(message));
}

}  // namespace

std::string_view StatusCodeName(StatusCode code) {
  switch (code) {
    case StatusCode::kOk:
      return "OK";
    case StatusCode::kCancelled:
      return "CANCELLED";
    case StatusCode::kInvalidArgument:
      return "INVALID_ARGUMENT";
    case StatusCode::kDeadlineExceeded:
      return "DEADLINE_EXCEEDED";
    case StatusCode::kNotFound:
      return "NOT_FOUND";
    case StatusCode::kAlreadyExists:
      return "ALREADY_EXISTS";
    case StatusCode::kPermissionDenied:
      return "PERMISSION_DENIED";
    case StatusCode::kResourceExhausted:
      return "RESOURCE_EXHAUSTED";
    case StatusCode::kFailedPrecondition:
      return "FAILED_PRECONDITION";
    case StatusCode::kAborted:
      return "ABORTED";
    case StatusCode::kUnimplemented:
      return "UNIMPLEMENTED";
    case StatusCode::kInternal:
      return "INTERNAL";
    case StatusCode::kUnavailable:
      return "UNAVAILABLE";
    case StatusCode::kDataLoss:
      return "DATA_LOSS";
    case StatusCode::kUnauthenticated:
      return "UNAUTHENTICATED";
  }
  // Reached by a number from outside alone: the switch has every code of ours.
  return "UNKNOWN";
}

Status::Status(StatusCode code, std::string reason, std::string message)
    : code_(code), reason_(std::move(reason)), message_(std::move(message)) {
  assert(code != StatusCode::kOk);
}

std::string Status::ToString() const {
  if (ok()) return "OK";
  return std::string(StatusCodeName(code_)) + " (" + reason_ + "): " + message_;
}

Status Status::WithContext(std::string_view context) const {
  if (ok()) return *this;
  return Make(code_, reason_, std::string(context) + ": " + message_);
}

Status InvalidArgument(std::string_view field, std::string_view message, std::string_view reason) {
  return Make(StatusCode::kInvalidArgument, reason,
              std::string(field) + ": " + std::string(message));
}

Status NotFound(std::string_view what, std::string_view reason) {
  return Make(StatusCode::kNotFound, reason, std::string(what) + " does not exist");
}

Status FailedPrecondition(std::string_view reason, std::string_view message) {
  return Make(StatusCode::kFailedPrecondition, reason, std::string(message));
}

Status ResourceExhausted(std::string_view reason, std::string_view message) {
  return Make(StatusCode::kResourceExhausted, reason, std::string(message));
}

Status InvalidFile(std::string_view where, std::string_view message) {
  return Make(StatusCode::kInvalidArgument, "INVALID_FILE",
              std::string(where) + ": " + std::string(message));
}

Status Internal(std::string_view message) {
  return Make(StatusCode::kInternal, "INTERNAL", std::string(message));
}

}  // namespace maploc
