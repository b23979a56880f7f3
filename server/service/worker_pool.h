// A fixed number of threads behind a bounded queue: what does not fit is refused at once, so that a
// flood costs a refusal and not memory. Thread-safe.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "mapstore/base/clock.h"

namespace maploc {

class WorkerPool {
 public:
  enum class Admission { kAccepted, kFull, kClosed };

  // REQUIRES: threads >= 1, max_waiting >= 0. `max_waiting` jobs may wait beside those that run,
  // and hold `max_waiting_bytes` together.
  WorkerPool(int threads, int max_waiting, std::size_t max_waiting_bytes);
  // Finishes every job that was accepted.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // `bytes`: what the job holds while it waits. What a job throws is dropped: jobs answer for
  // themselves.
  Admission Submit(std::size_t bytes, std::function<void()> job);
  // From now on kClosed.
  void Close();
  // Waits until no job runs or waits; false when the deadline came first.
  bool WaitUntilIdle(Deadline deadline);

 private:
  struct Job {
    std::size_t bytes;
    std::function<void()> run;
  };
  void Run();

  std::mutex mutex_;
  std::condition_variable work_;
  std::condition_variable idle_;
  std::deque<Job> jobs_;  // waiting
  std::size_t waiting_bytes_ = 0;
  const std::size_t max_jobs_;  // waiting and running
  const std::size_t max_waiting_bytes_;
  std::size_t running_ = 0;
  bool closed_ = false;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace maploc
