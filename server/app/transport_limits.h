// What connections may cost the server before a request reaches it. Constants, because a fleet's
// normal use stays far below them.
#pragma once

#include <cstddef>

namespace maploc {

// Raises the process's soft limit of descriptors to the hard one. To be called at its start.
void RaiseDescriptorLimit();

// How many connections the process's descriptors allow beside its own files; 8192 at most.
// Thread-safe.
std::size_t MaxConnections();

}  // namespace maploc
