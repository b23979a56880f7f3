// HTTP proxies of the environment, as gRPC takes them: grpc_proxy, https_proxy, http_proxy, and
// no_grpc_proxy, no_proxy for the hosts that go without.
#pragma once

#include <string>
#include <string_view>

namespace maploc {

// Whether `server` (HOST:PORT, or gRPC's ipv4:, ipv6:, dns: and unix: forms) is this machine
// itself, which no proxy can reach for it: localhost, 127.0.0.0/8, ::1, the wildcard addresses, a
// socket file.
bool IsLoopback(std::string_view server);

// "http://proxy:3128 of https_proxy" where calls to `server` go through a proxy, else "". A user
// and password in it are left out.
std::string ProxyInUse(std::string_view server);

}  // namespace maploc
