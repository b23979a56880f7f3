#include "server/app/listening_sockets.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

namespace maploc {
namespace {

// The port that the system chose for the first address may be taken at the second one.
constexpr int kTriesOfFreePort = 8;

struct FreeAddresses {
  void operator()(addrinfo* addresses) const { freeaddrinfo(addresses); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

struct HostAndPort {
  std::string host;
  std::string port;
};

// REQUIRES: a colon before the port.
HostAndPort Split(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  std::string host = address.substr(0, colon);
  for (const std::string_view scheme : {"dns:///", "dns:", "ipv4:", "ipv6:"}) {
    if (!host.starts_with(scheme)) continue;
    host.erase(0, scheme.size());
    break;
  }
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  return {host, address.substr(colon + 1)};
}

Addresses Resolve(const std::string& host, const std::string& port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV | AI_PASSIVE;
  addrinfo* found = nullptr;
  const int failed = getaddrinfo(host.c_str(), port.c_str(), &hints, &found);
  return Addresses(failed == 0 ? found : nullptr);
}

void SetPort(sockaddr* address, int port) {
  if (address->sa_family == AF_INET6) {
    reinterpret_cast<sockaddr_in6*>(address)->sin6_port = htons(static_cast<std::uint16_t>(port));
  } else {
    reinterpret_cast<sockaddr_in*>(address)->sin_port = htons(static_cast<std::uint16_t>(port));
  }
}

int PortOf(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  const bool six = address.ss_family == AF_INET6;
  return ntohs(six ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                   : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

void Set(int socket, int level, int option, int value) {
  setsockopt(socket, level, option, &value, sizeof(value));
}

// None, with errno, where the address cannot be used. No SO_REUSEPORT: a second server would take
// half of the connections. SO_REUSEADDR: old connections do not keep a new server from starting.
OwnedFd ListenOnOne(const addrinfo& address) {
  OwnedFd fd(socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fd) return fd;
  Set(fd.get(), SOL_SOCKET, SO_REUSEADDR, 1);
  // Else the system's setting (net.ipv6.bindv6only) decides whether [::] takes IPv4.
  if (address.ai_family == AF_INET6) Set(fd.get(), IPPROTO_IPV6, IPV6_V6ONLY, 0);
  const bool listens =
      bind(fd.get(), address.ai_addr, address.ai_addrlen) == 0 && listen(fd.get(), SOMAXCONN) == 0;
  return listens ? std::move(fd) : OwnedFd();
}

// Without sockets: none of the addresses is this machine's, or (errno EADDRINUSE) a port is in use.
ListeningSockets ListenOnAll(const addrinfo* addresses, int port) {
  ListeningSockets result;
  result.port = port;
  for (const addrinfo* address = addresses; address != nullptr; address = address->ai_next) {
    SetPort(address->ai_addr, result.port);
    OwnedFd fd = ListenOnOne(*address);
    if (!fd && errno == EADDRINUSE) return {};
    // A name may have addresses that are not this machine's, such as ::1 without IPv6.
    if (!fd) continue;
    // What the system chose for the first address must be the port of the others, too.
    result.port = PortOf(fd.get());
    result.sockets.push_back(std::move(fd));
  }
  return result;
}

ListeningSockets ListenOnAnyPort(const addrinfo* addresses) {
  ListeningSockets result;
  for (int i = 0; i < kTriesOfFreePort && result.sockets.empty(); ++i) {
    result = ListenOnAll(addresses, 0);
  }
  return result;
}

ListeningSockets ListenOnHost(const std::string& host, int port) {
  const Addresses addresses = Resolve(host, "0");
  return port == 0 ? ListenOnAnyPort(addresses.get()) : ListenOnAll(addresses.get(), port);
}

bool IsLoopback(const sockaddr* address) {
  if (address->sa_family == AF_INET) {
    const auto* four = reinterpret_cast<const sockaddr_in*>(address);
    return ntohl(four->sin_addr.s_addr) >> 24 == IN_LOOPBACKNET;
  }
  const in6_addr& six = reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr;
  if (IN6_IS_ADDR_V4MAPPED(&six)) return six.s6_addr[12] == IN_LOOPBACKNET;
  return IN6_IS_ADDR_LOOPBACK(&six) != 0;
}

Status CannotListen(const std::string& address, const std::string& why) {
  return Status(StatusCode::kUnavailable, "CANNOT_LISTEN",
                "cannot listen on " + address + ": " + why);
}

std::string CureOf(int error) {
  if (error == EADDRINUSE) return "stop the program that has the port, or choose another one";
  if (error == EACCES) return "choose a port above 1023, or start as root";
  return "give an address of this machine";
}

bool IsEveryAddress(const std::string& host) { return host == "0.0.0.0" || host == "::"; }

}  // namespace

Status CheckHost(const std::string& option, const std::string& address) {
  const auto [host, port] = Split(address);
  if (Resolve(host, port) != nullptr) return Status::Ok();
  return InvalidArgument(option, "host '" + host + "' is unknown; give one of this machine's names",
                         "UNKNOWN_HOST");
}

bool IsSameAddress(const std::string& a, const std::string& b) {
  const HostAndPort one = Split(a);
  const HostAndPort other = Split(b);
  const int port = std::atoi(one.port.c_str());
  if (port == 0 || port != std::atoi(other.port.c_str())) return false;
  if (IsEveryAddress(one.host) || IsEveryAddress(other.host)) return true;
  const Addresses left = Resolve(one.host, "0");
  const Addresses right = Resolve(other.host, "0");
  for (const addrinfo* l = left.get(); l != nullptr; l = l->ai_next) {
    for (const addrinfo* r = right.get(); r != nullptr; r = r->ai_next) {
      if (l->ai_addrlen == r->ai_addrlen &&
          std::memcmp(l->ai_addr, r->ai_addr, l->ai_addrlen) == 0) {
        return true;
      }
    }
  }
  return false;
}

bool IsBeyondLoopback(const std::string& address) {
  const Addresses addresses = Resolve(Split(address).host, "0");
  for (const addrinfo* one = addresses.get(); one != nullptr; one = one->ai_next) {
    if (!IsLoopback(one->ai_addr)) return true;
  }
  return false;
}

Result<ListeningSockets> ListenOn(const std::string& address) {
  const HostAndPort split = Split(address);
  const int port = std::atoi(split.port.c_str());
  if (Resolve(split.host, "0") == nullptr) {
    return CannotListen(address, "the host is unknown; give one of this machine's names");
  }
  errno = 0;
  // An IPv6 socket takes both families; a machine without IPv6 has none.
  ListeningSockets result = ListenOnHost(IsEveryAddress(split.host) ? "::" : split.host, port);
  if (result.sockets.empty() && errno != EADDRINUSE && IsEveryAddress(split.host)) {
    result = ListenOnHost("0.0.0.0", port);
  }
  if (!result.sockets.empty()) return result;
  return CannotListen(address, std::string(std::strerror(errno)) + "; " + CureOf(errno));
}

}  // namespace maploc
