// Whether the server can do its work, as its threads report it. Thread-safe.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "mapstore/base/status.h"

namespace maploc {

class Health {
 public:
  // `turned` is called by the reporting thread whenever good() has changed; it must not call back.
  explicit Health(std::function<void()> turned = {}) : turned_(std::move(turned)) {}

  // A round of a thread's work, `part` in a person's words. What it throws is INTERNAL. A failure
  // is logged when it begins or becomes another one, not each round, and once more when it is over.
  void Run(const std::string& part, const std::function<Status()>& round);
  // No part fails.
  bool good() const { return good_; }

 private:
  void Report(const std::string& part, const Status& status);

  const std::function<void()> turned_;
  std::atomic<bool> good_ = true;
  std::mutex mutex_;
  std::map<std::string, Status> failing_;
};

}  // namespace maploc
