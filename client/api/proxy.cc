#include "client/api/proxy.h"

#include <algorithm>
#include <cstdlib>

#include <arpa/inet.h>
#include <netinet/in.h>

namespace maploc {
namespace {

// "dns:///host:1" and "ipv4:1.2.3.4:1" without their scheme.
std::string_view WithoutScheme(std::string_view server) {
  for (const std::string_view scheme : {"dns:", "ipv4:", "ipv6:"}) {
    if (!server.starts_with(scheme)) continue;
    server.remove_prefix(scheme.size());
    return server.substr(std::min(server.rfind('/') + 1, server.size()));
  }
  return server;
}

// "[::1]:50051" -> "::1", "yard:50051" -> "yard".
std::string_view HostOf(std::string_view server) {
  server = WithoutScheme(server);
  if (server.starts_with('[')) return server.substr(1, server.find(']') - 1);
  const std::size_t colon = server.find(':');
  return colon == server.rfind(':') ? server.substr(0, colon) : server;  // else a bare IPv6 address
}

std::string_view Environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string_view() : value;
}

// gRPC's rule: comma-separated, each entry the end of a host's name.
bool GoesWithoutProxy(std::string_view host) {
  std::string_view list = Environment("no_grpc_proxy");
  if (list.empty()) list = Environment("no_proxy");
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    std::string_view entry = list.substr(0, comma);
    list.remove_prefix(std::min(comma + 1, list.size()));
    while (entry.starts_with(' ')) entry.remove_prefix(1);
    while (entry.ends_with(' ')) entry.remove_suffix(1);
    if (!entry.empty() && host.ends_with(entry)) return true;
  }
  return false;
}

std::string WithoutUser(std::string_view proxy) {
  const std::size_t at = proxy.rfind('@');
  if (at == std::string_view::npos) return std::string(proxy);
  const std::size_t scheme = proxy.find("://");
  const std::string_view head =
      scheme == std::string_view::npos ? std::string_view() : proxy.substr(0, scheme + 3);
  return std::string(head) + std::string(proxy.substr(at + 1));
}

// 127.0.0.0/8. As an address and not as a name's beginning: 127.example.org may be anybody's, and a
// token would go there in the clear.
bool IsInLoopbackNet(std::string_view host) {
  in_addr address{};
  return inet_pton(AF_INET, std::string(host).c_str(), &address) == 1 &&
         ntohl(address.s_addr) >> 24 == IN_LOOPBACKNET;
}

}  // namespace

bool IsLoopback(std::string_view server) {
  // With the colon, because a host may be called unix-server.
  if (server.starts_with("unix:") || server.starts_with("unix-abstract:")) return true;
  const std::string_view host = HostOf(server);
  return host == "localhost" || IsInLoopbackNet(host) || host == "::1" || host == "0.0.0.0" ||
         host == "::";
}

std::string ProxyInUse(std::string_view server) {
  if (IsLoopback(server) || GoesWithoutProxy(HostOf(server))) return "";
  // In gRPC's order.
  for (const char* name : {"grpc_proxy", "https_proxy", "http_proxy"}) {
    const std::string_view proxy = Environment(name);
    if (!proxy.empty()) return WithoutUser(proxy) + " of " + name;
  }
  return "";
}

}  // namespace maploc
