// The open connections of a server. gRPC, which has them, closes them without a word, so their
// descriptors are looked at: a number that is closed, or stands for another file by now, was
// closed. Thread-safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include <sys/types.h>

#include "mapstore/base/owned_fd.h"

namespace maploc {

class Connections {
 public:
  explicit Connections(std::size_t max_open) : max_open_(max_open) {}

  enum class Accepted { kYes, kNone, kTooMany };
  // Accepts one at `socket` into `fd`. kNone: errno says why. kTooMany: it was closed at once.
  Accepted Accept(int socket, OwnedFd* fd);
  // Ends the one whose peer gRPC calls `peer`, and drops what was sent on it and not read. Its
  // descriptor stays gRPC's, which finds it broken. Nothing happens where there is none.
  void Abort(const std::string& peer);
  std::size_t max_open() const { return max_open_; }

  // A call of this peer has arrived whole: what the connection has sent until now is no unfinished
  // upload.
  void NoteCall(const std::string& peer);
  // Ends the connections whose upload lasts longest until all unfinished ones are `max_bytes` at
  // most; how many it ended. A system call or two for each connection.
  int LimitUploads(std::uint64_t max_bytes);

 private:
  struct Connection {
    dev_t device;
    ino_t inode;
    std::string peer;
    std::uint64_t finished_bytes = 0;  // received until its last call
    std::chrono::steady_clock::time_point upload_began;
  };
  struct Upload {
    std::chrono::steady_clock::time_point began;
    std::uint64_t bytes;
    int fd;
  };
  static bool IsOpen(int fd, const Connection& connection);
  // REQUIRES of these: mutex_ is held.
  Connection* Find(const std::string& peer);
  // Before the number stands for another one: else the names of closed ones stay for ever.
  void ForgetPeerOf(int fd);
  void ForgetClosed();
  bool AreTooMany();
  std::vector<Upload> Uploads();

  const std::size_t max_open_;
  // Held while one is accepted, too: no number comes again while it is looked at.
  std::mutex mutex_;
  std::unordered_map<int, Connection> open_;
  std::unordered_map<std::string, int> fd_of_peer_;
};

}  // namespace maploc
