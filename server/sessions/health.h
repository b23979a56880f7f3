// Whether the server can do its work, as its threads report it. Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "mapstore/base/clock.h"
#include "mapstore/base/status.h"

namespace maploc {

// Another process that holds the store (STORE_BUSY: a large import, a backup of another program) is
// no fault before this: robots are localized meanwhile, what they teach waits in memory.
inline constexpr std::chrono::seconds kBusyMayLast{30};

class Health {
 public:
  // `turned` is called by the reporting thread whenever good() has changed; it must not call back.
  explicit Health(std::function<void()> turned = {}, const Clock& clock = SystemClock())
      : turned_(std::move(turned)), clock_(clock) {}

  // A round of a thread's work, `part` in a person's words. What it throws is INTERNAL. A failure
  // is logged when it begins, becomes another one or turns bad, not each round, and once more when
  // it is over.
  void Run(const std::string& part, const std::function<Status()>& round);
  // No part fails, but for one that has met nothing else than STORE_BUSY, for less than
  // kBusyMayLast.
  bool good() const { return good_; }

 private:
  struct Failure {
    std::chrono::steady_clock::time_point since;  // when its first round began
    std::string told;                             // the reason that the log has last
    bool bad = false;                             // until a round succeeds
  };

  void Report(const std::string& part, const Status& status,
              std::chrono::steady_clock::time_point began);
  void Fail(const std::string& part, const Status& status, Failure& failure) const;

  const std::function<void()> turned_;
  const Clock& clock_;
  std::atomic<bool> good_ = true;
  std::mutex mutex_;
  std::map<std::string, Failure> failing_;  // guarded by mutex_
};

}  // namespace maploc
