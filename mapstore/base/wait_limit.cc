#include "mapstore/base/wait_limit.h"

namespace maploc {
namespace {

thread_local const WaitLimit* innermost = nullptr;

}  // namespace

WaitLimit::WaitLimit(Deadline deadline, const std::atomic<bool>* stop)
    : deadline_(deadline), stop_(stop), outer_(innermost) {
  innermost = this;
}

WaitLimit::~WaitLimit() { innermost = outer_; }

Deadline WaitLimit::CurrentDeadline() {
  return innermost == nullptr ? kNoDeadline : innermost->deadline_;
}

bool WaitLimit::HasPassed() {
  if (innermost == nullptr) return false;
  if (innermost->stop_ != nullptr && *innermost->stop_) return true;
  return std::chrono::steady_clock::now() >= innermost->deadline_;
}

}  // namespace maploc
