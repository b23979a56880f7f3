// Time as a dependency, so that a test can turn the hands. Wall time goes into stored rows, steady
// time into durations.
#pragma once

#include <chrono>
#include <cstdint>

namespace maploc {

// Thread-safe.
class Clock {
 public:
  virtual ~Clock() = default;
  // Nanoseconds since the Unix epoch, UTC.
  virtual std::int64_t NowUnixNanos() const = 0;
  virtual std::chrono::steady_clock::time_point SteadyNow() const = 0;
};

// The process's real clock; lives for ever.
const Clock& SystemClock();

using Deadline = std::chrono::steady_clock::time_point;
inline constexpr Deadline kNoDeadline = Deadline::max();

}  // namespace maploc
