// How long the calling thread may wait for what others hold: a lock of the store, of this process
// or of another one. Set where a request or a round of work begins, heeded where it is waited, so
// that no signature in between has to carry it.
#pragma once

#include <atomic>

#include "mapstore/base/clock.h"

namespace maploc {

// In force for this thread while it lives; the innermost one counts. Not to be moved to another
// thread.
class WaitLimit {
 public:
  // `stop` outlives it; once it is true nothing is waited for. May be null.
  explicit WaitLimit(Deadline deadline, const std::atomic<bool>* stop = nullptr);
  ~WaitLimit();
  WaitLimit(const WaitLimit&) = delete;
  WaitLimit& operator=(const WaitLimit&) = delete;

  // Of the calling thread; kNoDeadline where it has no limit.
  static Deadline CurrentDeadline();
  static bool HasPassed();

 private:
  const Deadline deadline_;
  const std::atomic<bool>* const stop_;
  const WaitLimit* const outer_;
};

}  // namespace maploc
