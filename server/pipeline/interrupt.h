// When to stop working on a query.
#pragma once

#include <atomic>

#include "mapstore/base/clock.h"
#include "mapstore/base/status.h"

namespace maploc {

// Whether a query was stopped because its time was up. If it already has an answer, that answer is
// returned: "not localized" counts in the statistics, an error does not.
inline bool IsOutOfTime(const Status& status) {
  return status.code() == StatusCode::kDeadlineExceeded;
}

struct Interrupt {
  Deadline deadline = kNoDeadline;
  const std::atomic<bool>* cancelled = nullptr;  // may be null

  // CANCELLED, DEADLINE_EXCEEDED or ok.
  Status Check() const {
    if (cancelled != nullptr && cancelled->load(std::memory_order_relaxed)) {
      return Status(StatusCode::kCancelled, "CANCELLED", "the caller gave the query up");
    }
    if (deadline != kNoDeadline && std::chrono::steady_clock::now() >= deadline) {
      return Status(StatusCode::kDeadlineExceeded, "DEADLINE_EXCEEDED",
                    "the deadline passed while the query was worked on; allow more time, or send "
                    "fewer features");
    }
    return Status::Ok();
  }
};

}  // namespace maploc
