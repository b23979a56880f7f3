// Processor time of the calling thread: what else runs on the machine does not count.
#pragma once

#include <ctime>

namespace maploc::experiments {

class CpuTimer {
 public:
  CpuTimer() : start_ms_(Now()) {}
  double ElapsedMs() const { return Now() - start_ms_; }

 private:
  static double Now() {
    timespec now = {};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
  }

  double start_ms_;
};

}  // namespace maploc::experiments
