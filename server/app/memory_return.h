// Gives memory that is no longer used back to the system, in a thread of its own: glibc keeps what
// lies below a block in use, so that after a flood of large messages it would keep most of it.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

namespace maploc {

class MemoryReturn {
 public:
  MemoryReturn();
  ~MemoryReturn();
  MemoryReturn(const MemoryReturn&) = delete;
  MemoryReturn& operator=(const MemoryReturn&) = delete;

 private:
  void Run();

  std::mutex mutex_;
  std::condition_variable stop_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace maploc
