// A clock whose hands a test turns. Thread-safe.
#pragma once

#include <atomic>

#include "mapstore/base/clock.h"

namespace maploc::testing {

class FakeClock final : public Clock {
 public:
  std::int64_t NowUnixNanos() const override { return kStartUnixNs + nanos_; }
  std::chrono::steady_clock::time_point SteadyNow() const override {
    return std::chrono::steady_clock::time_point(std::chrono::hours(1)) +
           std::chrono::nanoseconds(nanos_);
  }
  void Advance(std::chrono::nanoseconds by) { nanos_ += by.count(); }

 private:
  static constexpr std::int64_t kStartUnixNs = 1'700'000'000'000'000'000;
  std::atomic<std::int64_t> nanos_ = 0;
};

}  // namespace maploc::testing
