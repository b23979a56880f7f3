#include "server/app/connections.h"

#include <algorithm>

#include <arpa/inet.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>

namespace maploc {
namespace {

constexpr std::uint64_t kLeastUploadBytes = 64 << 10;

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

// What was sent and not read is dropped, too.
// To connect to nobody resets a TCP connection and leaves the descriptor to its owner. shutdown()
// would leave gRPC to read on.
void Disconnect(int fd) {
  const sockaddr nobody{};  // AF_UNSPEC
  static_cast<void>(connect(fd, &nobody, sizeof(nobody)));
}

// The kernel's count, because gRPC does not tell how much of a message it has.
std::uint64_t ReceivedBytes(int fd) {
  tcp_info info{};
  socklen_t size = sizeof(info);
  getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size);
  return info.tcpi_bytes_received;
}

}  // namespace

Connections::Accepted Connections::Accept(int socket, OwnedFd* fd) {
  const std::lock_guard lock(mutex_);
  sockaddr_storage peer{};
  socklen_t size = sizeof(peer);
  *fd = OwnedFd(
      accept4(socket, reinterpret_cast<sockaddr*>(&peer), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!*fd) return Accepted::kNone;
  // Accepted and then closed: left in the socket's queue it would wake the acceptor again at once.
  if (AreTooMany()) return *fd = OwnedFd(), Accepted::kTooMany;
  SendAtOnce(fd->get());
  struct stat status {};
  fstat(fd->get(), &status);
  const std::string name = PeerName(peer);
  ForgetPeerOf(fd->get());
  open_[fd->get()] = {status.st_dev, status.st_ino, name, 0, std::chrono::steady_clock::now()};
  fd_of_peer_[name] = fd->get();
  return Accepted::kYes;
}

void Connections::ForgetPeerOf(int fd) {
  const auto connection = open_.find(fd);
  if (connection == open_.end()) return;
  const auto known = fd_of_peer_.find(connection->second.peer);
  if (known != fd_of_peer_.end() && known->second == fd) fd_of_peer_.erase(known);
}

void Connections::ForgetClosed() {
  std::erase_if(open_, [this](const auto& entry) {
    const auto& [fd, connection] = entry;
    if (IsOpen(fd, connection)) return false;
    ForgetPeerOf(fd);
    return true;
  });
}

// Null: there is none.
Connections::Connection* Connections::Find(const std::string& peer) {
  const auto known = fd_of_peer_.find(peer);
  if (known == fd_of_peer_.end()) return nullptr;
  const auto connection = open_.find(known->second);
  return connection == open_.end() ? nullptr : &connection->second;
}

// Looks at all of them only where they may be too many.
bool Connections::AreTooMany() {
  if (open_.size() < max_open_) return false;
  ForgetClosed();
  return open_.size() >= max_open_;
}

void Connections::Abort(const std::string& peer) {
  const std::lock_guard lock(mutex_);
  const Connection* const connection = Find(peer);
  if (connection == nullptr) return;
  const int fd = fd_of_peer_.at(peer);
  if (IsOpen(fd, *connection)) Disconnect(fd);
}

void Connections::NoteCall(const std::string& peer) {
  const std::lock_guard lock(mutex_);
  Connection* const connection = Find(peer);
  if (connection == nullptr) return;
  connection->finished_bytes = ReceivedBytes(fd_of_peer_.at(peer));
  connection->upload_began = std::chrono::steady_clock::now();
}

// Notes where an upload begins: a few bytes are pings, settings and headers.
std::vector<Connections::Upload> Connections::Uploads() {
  const auto now = std::chrono::steady_clock::now();
  std::vector<Upload> uploads;
  for (auto& [fd, connection] : open_) {
    const std::uint64_t received = ReceivedBytes(fd);
    const std::uint64_t bytes = received - std::min(received, connection.finished_bytes);
    if (bytes < kLeastUploadBytes) {
      connection.upload_began = now;
    } else {
      uploads.push_back({connection.upload_began, bytes, fd});
    }
  }
  return uploads;
}

int Connections::LimitUploads(std::uint64_t max_bytes) {
  const std::lock_guard lock(mutex_);
  ForgetClosed();
  std::vector<Upload> uploads = Uploads();
  std::uint64_t all = 0;
  for (const Upload& upload : uploads) all += upload.bytes;
  // The longest first: an honest upload is over within moments, one that holds memory on purpose is
  // not.
  std::ranges::sort(uploads, {}, &Upload::began);
  int ended = 0;
  for (const Upload& upload : uploads) {
    if (all <= max_bytes) break;
    Disconnect(upload.fd);
    all -= upload.bytes;
    ++ended;
  }
  return ended;
}

bool Connections::IsOpen(int fd, const Connection& connection) {
  struct stat status {};
  return fstat(fd, &status) == 0 && status.st_dev == connection.device &&
         status.st_ino == connection.inode;
}

}  // namespace maploc
