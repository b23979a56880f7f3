// A fixed number of threads behind a bounded queue: what does not fit is refused at once, so that a
// flood costs a refusal and not memory. Those who send jobs (peers) share it fairly: the threads
// take one of each in turn, and in a full queue the newest of whoever has the most makes room for
// one who has fewer. Thread-safe.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
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

  struct Job {
    std::size_t bytes = 0;          // that it holds while it waits
    std::function<void()> run;      // what it throws is dropped: jobs answer for themselves
    std::function<void()> dropped;  // in place of `run`, by the thread that submits another's job
  };
  // Where it is not accepted neither function is called.
  Admission Submit(const std::string& peer, Job job);
  // From now on kClosed.
  void Close();
  // Jobs that run or wait.
  std::size_t jobs();
  // Waits until no job runs or waits; false when the deadline came first.
  bool WaitUntilIdle(Deadline deadline);

 private:
  struct Waiting {
    std::string peer;
    Job job;
  };
  // REQUIRES of these: mutex_ is held.
  bool Fits(std::size_t bytes) const;
  // False: no fair choice makes room, and nobody's job was taken.
  bool MakeRoom(const std::string& peer, std::size_t bytes, std::vector<Waiting>* dropped);
  void GiveBack(std::vector<Waiting>* taken);
  Job TakeNewest(const std::string& peer);
  Job TakeNext();
  void Run();

  std::mutex mutex_;
  std::condition_variable work_;
  std::condition_variable idle_;
  std::map<std::string, std::deque<Job>> waiting_;  // of peers that have any
  std::deque<std::string> turns_;                   // these peers; the first is next
  std::size_t waiting_jobs_ = 0;
  std::size_t waiting_bytes_ = 0;
  const std::size_t max_jobs_;  // waiting and running
  const std::size_t max_waiting_bytes_;
  std::size_t running_ = 0;
  bool closed_ = false;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace maploc
