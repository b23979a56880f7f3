// Failure as a value. Status carries one of gRPC's canonical codes, an UPPER_SNAKE reason that
// programs may rely on, and a message that names the cause and the cure for a person. Result<T> is
// a T or the Status that explains its absence. Both are plain values: const access from several
// threads is safe.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace maploc {

// The numbers are gRPC's (grpc::StatusCode), so the service maps them without a table.
enum class StatusCode {
  kOk = 0,
  kCancelled = 1,
  kInvalidArgument = 3,
  kDeadlineExceeded = 4,
  kNotFound = 5,
  kAlreadyExists = 6,
  kPermissionDenied = 7,
  kResourceExhausted = 8,
  kFailedPrecondition = 9,
  kAborted = 10,
  kUnimplemented = 12,
  kInternal = 13,
  kUnavailable = 14,
  kDataLoss = 15,
  kUnauthenticated = 16,
};

// "INVALID_ARGUMENT" and so on, as gRPC prints them.
std::string_view StatusCodeName(StatusCode code);

class [[nodiscard]] Status {
 public:
  Status() = default;
  // REQUIRES: code != kOk; reason is UPPER_SNAKE.
  Status(StatusCode code, std::string reason, std::string message);

  static Status Ok() { return Status(); }

  bool ok() const { return code_ == StatusCode::kOk; }
  StatusCode code() const { return code_; }
  const std::string& reason() const { return reason_; }
  const std::string& message() const { return message_; }
  // "INVALID_ARGUMENT (ZERO_FOCAL_LENGTH): views[0].camera.params[0] is 0; ..." on one line.
  std::string ToString() const;
  // The same failure seen from further out: "context: message". Ok stays Ok.
  Status WithContext(std::string_view context) const;

 private:
  StatusCode code_ = StatusCode::kOk;
  std::string reason_;
  std::string message_;
};

// The field's path stands first in the message: "views[0].points.coordinates: holds a NaN at index
// 12".
Status InvalidArgument(std::string_view field, std::string_view message,
                       std::string_view reason = "INVALID_FIELD");
// `what` says which thing, for example "map 'yard'".
Status NotFound(std::string_view what, std::string_view reason = "NOT_FOUND");
Status FailedPrecondition(std::string_view reason, std::string_view message);
Status ResourceExhausted(std::string_view reason, std::string_view message);
// A file's content is wrong. `where` is "path" or "path:line".
Status InvalidFile(std::string_view where, std::string_view message);
Status Internal(std::string_view message);

template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}  // NOLINT: implicit on purpose
  // REQUIRES: !status.ok()
  Result(Status status) : status_(std::move(status)) { assert(!status_.ok()); }  // NOLINT

  bool ok() const { return value_.has_value(); }
  const Status& status() const { return status_; }

  // REQUIRES: ok()
  const T& value() const& { return assert(ok()), *value_; }
  T& value() & { return assert(ok()), *value_; }
  T&& value() && { return assert(ok()), *std::move(value_); }
  const T& operator*() const& { return value(); }
  T& operator*() & { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  const T* operator->() const { return &value(); }
  T* operator->() { return &value(); }

 private:
  std::optional<T> value_;
  Status status_;
};

}  // namespace maploc

#define MAPLOC_CONCAT_INNER(a, b) a##b
#define MAPLOC_CONCAT(a, b) MAPLOC_CONCAT_INNER(a, b)
// Returns the Status of `expression` from the calling function unless it is ok.
#define MAPLOC_RETURN_IF_ERROR(expression)                                      \
  do {                                                                          \
    if (::maploc::Status status_ = (expression); !status_.ok()) return status_; \
  } while (false)
// MAPLOC_ASSIGN_OR_RETURN(auto x, F()); a Result's value, or return its Status.
#define MAPLOC_ASSIGN_OR_RETURN(declaration, expression) \
  MAPLOC_ASSIGN_OR_RETURN_INNER(MAPLOC_CONCAT(result_, __LINE__), declaration, expression)
#define MAPLOC_ASSIGN_OR_RETURN_INNER(result, declaration, expression) \
  auto result = (expression);                                          \
  if (!result.ok()) return result.status();                            \
  declaration = std::move(result).value()
