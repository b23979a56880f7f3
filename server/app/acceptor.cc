#include "server/app/acceptor.h"

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>

#include "server/app/seldom.h"

namespace maploc {
namespace {

// Between two looks at the uploads; also until what the kernel lacks may be there again.
constexpr std::chrono::milliseconds kRound{20};
// Of messages that have not arrived whole, on all connections; each may have 21 MB.
constexpr std::uint64_t kMaxUploadBytes = 64 << 20;
// Connections that come without end must hold up neither the stop nor the look at the uploads; with
// 8192 open ones each takes some milliseconds, because all are looked at.
constexpr int kMostAtOnce = 16;

// Of the process or the machine, and over some time.
bool IsShortage(int error) {
  return error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM;
}

// The socket itself is none, or listens no more. Every other error is the connection's.
bool IsLoss(int error) {
  return error == EBADF || error == EINVAL || error == ENOTSOCK || error == EOPNOTSUPP;
}

OwnedFd NewEvent() {
  OwnedFd event(eventfd(0, EFD_CLOEXEC));
  if (!event) throw std::system_error(errno, std::generic_category(), "eventfd");
  return event;
}

}  // namespace

// What the thread knows between two connections.
class Acceptor::Loop {
 public:
  Loop(Connections* connections, const AcceptorOptions& options)
      : connections_(connections), options_(options) {}

  enum class Next { kWait, kPause, kEnd };
  // Accepts what waits at `socket`, kMostAtOnce at most: poll returns at once for the others.
  Next AcceptSome(int socket) {
    for (int i = 0; i < kMostAtOnce; ++i) {
      OwnedFd fd;
      const Connections::Accepted accepted = connections_->Accept(socket, &fd);
      // At once, before a call below changes it.
      const int error = errno;
      if (accepted == Connections::Accepted::kYes) {
        options_.accepted(fd.Release());
      } else if (accepted == Connections::Accepted::kTooMany) {
        Tell(std::to_string(connections_->max_open()) + " are open, the most there may be");
      } else if (error == EAGAIN) {
        return Next::kWait;
      } else if (IsShortage(error)) {
        return Tell(std::strerror(error)), Next::kPause;
      } else if (IsLoss(error)) {
        return Lose(error), Next::kEnd;
      }
    }
    return Next::kWait;
  }
  void LimitUploads() {
    if (connections_->LimitUploads(kMaxUploadBytes) > 0 && disconnected_.IsTime()) {
      spdlog::warn("connections are ended: unfinished uploads take more than {} MiB",
                   kMaxUploadBytes >> 20);
    }
  }

 private:
  void Lose(int error) const {
    spdlog::error("no connection can be accepted any more: {}", std::strerror(error));
    options_.lost();
  }
  void Tell(const std::string& why) {
    if (refused_.IsTime()) spdlog::warn("connections are refused: {}", why);
  }

  Connections* connections_;
  AcceptorOptions options_;
  Seldom refused_;
  Seldom disconnected_;
};

Acceptor::Acceptor(ListeningSockets sockets, Connections* connections,
                   const AcceptorOptions& options)
    // The thread owns the sockets, so that the port is free when the destructor has joined it.
    : stop_(NewEvent()),
      thread_([this, sockets = std::move(sockets), loop = Loop(connections, options)] {
        Run(sockets, loop);
      }) {}

Acceptor::~Acceptor() {
  const std::uint64_t one = 1;
  // It fails only when the event's counter is full, and then the thread is awake already.
  static_cast<void>(!write(stop_.get(), &one, sizeof(one)));
  thread_.join();
}

void Acceptor::Run(const ListeningSockets& sockets, Loop loop) const {
  std::vector<pollfd> waiting{{stop_.get(), POLLIN, 0}};
  for (const OwnedFd& socket : sockets.sockets) waiting.push_back({socket.get(), POLLIN, 0});
  bool pause = false;
  auto next_look = std::chrono::steady_clock::now();
  while (true) {
    // In a pause only the end is waited for: the sockets are ready all the while.
    poll(waiting.data(), pause ? 1 : waiting.size(), kRound.count());
    if (waiting.front().revents != 0) return;
    pause = false;
    if (std::chrono::steady_clock::now() >= next_look) {
      loop.LimitUploads();
      next_look = std::chrono::steady_clock::now() + kRound;
    }
    for (std::size_t i = 1; i < waiting.size(); ++i) {
      const Loop::Next next = loop.AcceptSome(waiting[i].fd);
      if (next == Loop::Next::kEnd) return;
      pause = pause || next == Loop::Next::kPause;
    }
  }
}

}  // namespace maploc
