#include "server/app/memory_return.h"

#include <algorithm>
#include <chrono>
#include <cstddef>

#include <malloc.h>

namespace maploc {
namespace {

constexpr std::chrono::seconds kInterval{1};
// Less is wanted again soon.
constexpr std::size_t kMaxUnusedBytes = 32 << 20;

}  // namespace

MemoryReturn::MemoryReturn() : thread_([this] { Run(); }) {}

MemoryReturn::~MemoryReturn() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stop_.notify_all();
  thread_.join();
}

void MemoryReturn::Run() {
  std::size_t given_back = 0;  // glibc counts it as unused all the same
  std::unique_lock lock(mutex_);
  while (!stop_.wait_for(lock, kInterval, [this] { return stopping_; })) {
    const std::size_t unused = mallinfo2().fordblks;
    // A part of it may be in use again.
    given_back = std::min(given_back, unused);
    if (unused <= given_back + kMaxUnusedBytes) continue;
    malloc_trim(0);
    given_back = mallinfo2().fordblks;
  }
}

}  // namespace maploc
