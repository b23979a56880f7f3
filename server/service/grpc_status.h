// Failure as gRPC tells it: the same code, the reason behind the message and as trailing metadata,
// and the same again as google.rpc.Status, for clients that know nothing of maploc.
#pragma once

#include <optional>
#include <string>

#include <grpcpp/grpcpp.h>

#include "mapstore/base/status.h"

namespace maploc {

// ErrorInfo.domain: who defines the reasons.
inline constexpr char kErrorDomain[] = "maploc";
// Trailing metadata: the UPPER_SNAKE reason of every error.
inline constexpr char kReasonMetadata[] = "maploc-reason";
// Trailing metadata: milliseconds after which a repetition may succeed (gRFC A6); only where it
// may.
inline constexpr char kRetryDelayMetadata[] = "grpc-retry-pushback-ms";

// After how many milliseconds a repetition may succeed; nullopt: it never will. A call that is
// refused with a time has changed and counted nothing.
std::optional<int> RetryDelayMs(const Status& status);

// Adds the metadata to `context`; the status carries a google.rpc.Status with ErrorInfo, with
// BadRequest where a field is wrong, and with RetryInfo where a repetition may succeed. Nobody
// is told where the store lies.
grpc::Status ToGrpc(const Status& status, const std::string& store_path,
                    grpc::CallbackServerContext* context);

// Bytes that are no `message`, the full name of a proto message.
Status NotParsed(const std::string& message);

}  // namespace maploc
