// Accepts connections and limits their uploads in a thread of its own and hands them on; those
// beyond the limit are closed at once. A process that is out of descriptors or memory goes on
// listening: the connections wait.
//
// Thread-safe.
#pragma once

#include <functional>
#include <thread>

#include "mapstore/base/owned_fd.h"
#include "server/app/connections.h"
#include "server/app/listening_sockets.h"

namespace maploc {

struct AcceptorOptions {
  std::function<void(int fd)> accepted;  // takes the descriptor; called by the thread alone
  std::function<void()> lost;            // the sockets are of no use any more; once, by the thread
};

class Acceptor {
 public:
  // `connections` outlives it.
  Acceptor(ListeningSockets sockets, Connections* connections, const AcceptorOptions& options);
  // Listens no more; nobody is called any more when it returns.
  ~Acceptor();
  Acceptor(const Acceptor&) = delete;
  Acceptor& operator=(const Acceptor&) = delete;

 private:
  class Loop;
  void Run(const ListeningSockets& sockets, Loop loop) const;

  OwnedFd stop_;  // an eventfd
  std::thread thread_;
};

}  // namespace maploc
