// The sockets on which a server listens. They are the server's own and not gRPC's, because gRPC
// 1.51 gives its own up for good when the process is out of descriptors once.
#pragma once

#include <string>
#include <vector>

#include "mapstore/base/owned_fd.h"
#include "mapstore/base/status.h"

namespace maploc {

struct ListeningSockets {
  std::vector<OwnedFd> sockets;  // non-blocking; at least one
  int port = 0;                  // of all of them
};

// Listens on every address of HOST:PORT that this machine has; port 0 lets the system choose one
// for all. The host is a name, an IPv4 address, or an IPv6 address with or without brackets;
// 0.0.0.0 and :: both take IPv4 and IPv6. UNAVAILABLE (CANNOT_LISTEN) where a port is in use, also
// by a server that would share it, or where no address is this machine's. Thread-safe.
Result<ListeningSockets> ListenOn(const std::string& address);

// INVALID_ARGUMENT (UNKNOWN_HOST) with `option` in front where the host of HOST:PORT has no
// address.
Status CheckHost(const std::string& option, const std::string& address);

// Whether others than this machine itself can reach HOST:PORT: an address of the host's is not a
// loopback one. False where the host is unknown, on which nobody can listen either. Thread-safe.
bool IsBeyondLoopback(const std::string& address);

// Whether a socket on one HOST:PORT keeps another from the other. Thread-safe.
bool IsSameAddress(const std::string& a, const std::string& b);

}  // namespace maploc
