// Failure as gRPC tells it: the same code, the reason behind the message and as trailing metadata.
#pragma once

#include <grpcpp/grpcpp.h>

#include "mapstore/base/status.h"

namespace maploc {

// Trailing metadata: the UPPER_SNAKE reason of every error.
inline constexpr char kReasonMetadata[] = "maploc-reason";
// Trailing metadata: milliseconds after which a repetition may succeed (gRFC A6); only where it
// may.
inline constexpr char kRetryDelayMetadata[] = "grpc-retry-pushback-ms";

// Adds the metadata to `context`.
grpc::Status ToGrpc(const Status& status, grpc::CallbackServerContext* context);

}  // namespace maploc
