#include "server/app/connections.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/stat.h>

namespace maploc {
namespace {

// A pose is a small message that nobody should wait for.
void SendAtOnce(int fd) {
  const int on = 1;
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
}

// As grpc::ServerContext::peer() has it: an IPv4 address behind an IPv6 socket is IPv4, and the
// brackets of an IPv6 address are percent-encoded.
std::string PeerName(const sockaddr_storage& address) {
  char text[INET6_ADDRSTRLEN] = "";
  if (address.ss_family == AF_INET) {
    const auto& four = reinterpret_cast<const sockaddr_in&>(address);
    inet_ntop(AF_INET, &four.sin_addr, text, sizeof(text));
    return "ipv4:" + std::string(text) + ":" + std::to_string(ntohs(four.sin_port));
  }
  const auto& six = reinterpret_cast<const sockaddr_in6&>(address);
  const std::string port = std::to_string(ntohs(six.sin6_port));
  if (IN6_IS_ADDR_V4MAPPED(&six.sin6_addr)) {
    inet_ntop(AF_INET, &six.sin6_addr.s6_addr[12], text, sizeof(text));
    return "ipv4:" + std::string(text) + ":" + port;
  }
  inet_ntop(AF_INET6, &six.sin6_addr, text, sizeof(text));
  return "ipv6:%5B" + std::string(text) + "%5D:" + port;
}

}  // namespace

Connections::Accepted Connections::Accept(int socket, OwnedFd* fd) {
  const std::lock_guard lock(mutex_);
  sockaddr_storage peer{};
  socklen_t size = sizeof(peer);
  *fd = OwnedFd(
      accept4(socket, reinterpret_cast<sockaddr*>(&peer), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!*fd) return Accepted::kNone;
  if (AreTooMany()) return *fd = OwnedFd(), Accepted::kTooMany;
  SendAtOnce(fd->get());
  struct stat status {};
  fstat(fd->get(), &status);
  open_[fd->get()] = {status.st_dev, status.st_ino, PeerName(peer)};
  return Accepted::kYes;
}

// Looks at all of them only where they may be too many.
bool Connections::AreTooMany() {
  if (open_.size() < max_open_) return false;
  std::erase_if(open_, [](const auto& entry) { return !IsOpen(entry.first, entry.second); });
  return open_.size() >= max_open_;
}

void Connections::Abort(const std::string& peer) {
  const std::lock_guard lock(mutex_);
  for (const auto& [fd, connection] : open_) {
    if (connection.peer != peer || !IsOpen(fd, connection)) continue;
    const sockaddr nobody{};  // AF_UNSPEC
    connect(fd, &nobody, sizeof(nobody));
  }
}

bool Connections::IsOpen(int fd, const Connection& connection) {
  struct stat status {};
  return fstat(fd, &status) == 0 && status.st_dev == connection.device &&
         status.st_ino == connection.inode;
}

}  // namespace maploc
