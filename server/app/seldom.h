// What may happen a thousand times a second and is told once a minute. Not thread-safe.
#pragma once

#include <chrono>
#include <optional>

namespace maploc {

class Seldom {
 public:
  // At first, and a minute after it was true.
  bool IsTime() {
    const auto now = std::chrono::steady_clock::now();
    if (last_ && now - *last_ < std::chrono::minutes(1)) return false;
    last_ = now;
    return true;
  }

 private:
  std::optional<std::chrono::steady_clock::time_point> last_;
};

}  // namespace maploc
