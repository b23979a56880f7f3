#include "server/app/acceptor.h"

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>

namespace maploc {
namespace {

constexpr int kPauseMs = 100;  // until what the kernel lacks may be there again
// The same refusal is told so often at most, however many are refused.
constexpr std::chrono::minutes kTellAgain{1};

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
  // Accepts what waits at `socket`.
  Next AcceptAll(int socket) {
    while (true) {
      OwnedFd fd;
      const Connections::Accepted accepted = connections_->Accept(socket, &fd);
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
  }

 private:
  void Lose(int error) const {
    spdlog::error("no connection can be accepted any more: {}", std::strerror(error));
    options_.lost();
  }
  void Tell(const std::string& why) {
    const auto now = std::chrono::steady_clock::now();
    if (told_ && now - *told_ < kTellAgain) return;
    told_ = now;
    spdlog::warn("connections are refused: {}", why);
  }

  Connections* connections_;
  AcceptorOptions options_;
  std::optional<std::chrono::steady_clock::time_point> told_;
};

Acceptor::Acceptor(ListeningSockets sockets, Connections* connections,
                   const AcceptorOptions& options)
    : stop_(NewEvent()),
      thread_([this, sockets = std::move(sockets), loop = Loop(connections, options)] {
        Run(sockets, loop);
      }) {}

Acceptor::~Acceptor() {
  const std::uint64_t one = 1;
  static_cast<void>(!write(stop_.get(), &one, sizeof(one)));
  thread_.join();
}

void Acceptor::Run(const ListeningSockets& sockets, Loop loop) const {
  std::vector<pollfd> waiting{{stop_.get(), POLLIN, 0}};
  for (const OwnedFd& socket : sockets.sockets) waiting.push_back({socket.get(), POLLIN, 0});
  bool pause = false;
  while (true) {
    // In a pause only the end is waited for: the sockets are ready all the while.
    poll(waiting.data(), pause ? 1 : waiting.size(), pause ? kPauseMs : -1);
    if (waiting.front().revents != 0) return;
    pause = false;
    for (std::size_t i = 1; i < waiting.size(); ++i) {
      const Loop::Next next = loop.AcceptAll(waiting[i].fd);
      if (next == Loop::Next::kEnd) return;
      pause = pause || next == Loop::Next::kPause;
    }
  }
}

}  // namespace maploc
