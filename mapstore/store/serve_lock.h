// Says that a server serves a store: a lock on a file beside it, which the kernel lets go however
// the process dies. Two servers on one store would not see each other's open sessions: each would
// hand out the sequences that the other has given, and end what the other still fills.
#pragma once

#include <string>
#include <utility>

#include "mapstore/base/status.h"

namespace maploc {

// Held while it lives.
class ServeLock {
 public:
  // The file is STORE-server, of the path without links; the store itself need not exist yet.
  // UNAVAILABLE: STORE_IN_USE when another server, also one of this process, holds it; CANNOT_LOCK.
  static Result<ServeLock> Acquire(const std::string& store_path);

  ServeLock(ServeLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  ServeLock& operator=(ServeLock&&) = delete;
  ~ServeLock();

 private:
  explicit ServeLock(int file) : file_(file) {}

  int file_;
};

}  // namespace maploc
