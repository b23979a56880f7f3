// What connections may cost the server before a request reaches it. Constants, because a fleet's
// normal use stays far below them.
#pragma once

#include <cstddef>

#include <grpcpp/grpcpp.h>

#include "server/app/connections.h"

namespace maploc {

// Raises the process's soft limit of descriptors to the hard one. To be called at its start.
void RaiseDescriptorLimit();

// How many connections the process's descriptors allow beside its own files; 8192 at most.
// Thread-safe.
std::size_t MaxConnections();

// Limits streams and memory of the connections, and ends those whose peer is gone, silent or idle,
// or opens calls without end. `connections` outlives the server.
void LimitTransport(Connections* connections, grpc::ServerBuilder* builder);

}  // namespace maploc
