#include "server/service/worker_pool.h"

#include <algorithm>
#include <utility>

#include "server/sessions/caught.h"

namespace maploc {

WorkerPool::WorkerPool(int threads, int max_waiting, std::size_t max_waiting_bytes)
    : max_jobs_(static_cast<std::size_t>(threads) + static_cast<std::size_t>(max_waiting)),
      max_waiting_bytes_(max_waiting_bytes) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { Run(); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    stopping_ = true;
  }
  work_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

WorkerPool::Admission WorkerPool::Submit(const std::string& peer, Job job) {
  std::vector<Waiting> dropped;
  bool fits = false;
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return Admission::kClosed;
    fits = MakeRoom(peer, job.bytes, &dropped);
    if (fits) {
      ++waiting_jobs_;
      waiting_bytes_ += job.bytes;
      std::deque<Job>& own = waiting_[peer];
      if (own.empty()) turns_.push_back(peer);
      own.push_back(std::move(job));
    }
  }
  if (fits) work_.notify_one();
  // Without the lock, because it answers a call, and gRPC may run the answer in this thread.
  for (const Waiting& other : dropped) other.job.dropped();
  return fits ? Admission::kAccepted : Admission::kFull;
}

bool WorkerPool::Fits(std::size_t bytes) const {
  return waiting_jobs_ + running_ < max_jobs_ && waiting_bytes_ + bytes <= max_waiting_bytes_;
}

bool WorkerPool::MakeRoom(const std::string& peer, std::size_t bytes,
                          std::vector<Waiting>* dropped) {
  const auto own = waiting_.find(peer);
  const std::size_t mine = own == waiting_.end() ? 0 : own->second.size();
  while (!Fits(bytes)) {
    const auto most = std::ranges::max_element(
        waiting_, {}, [](const auto& entry) { return entry.second.size(); });
    // A peer that has one job more than the newcomer keeps it: they would only change places.
    if (most == waiting_.end() || most->second.size() <= mine + 1) return GiveBack(dropped), false;
    dropped->push_back({most->first, TakeNewest(most->first)});
  }
  return true;
}

void WorkerPool::GiveBack(std::vector<Waiting>* taken) {
  // From the last on, so that each peer's jobs are in their order again. Each peer has kept a job,
  // and so its turn.
  for (; !taken->empty(); taken->pop_back()) {
    Waiting& last = taken->back();
    ++waiting_jobs_;
    waiting_bytes_ += last.job.bytes;
    waiting_.at(last.peer).push_back(std::move(last.job));
  }
}

WorkerPool::Job WorkerPool::TakeNewest(const std::string& peer) {
  // It has another one, so its turn stays.
  std::deque<Job>& jobs = waiting_.at(peer);
  Job job = std::move(jobs.back());
  jobs.pop_back();
  --waiting_jobs_;
  waiting_bytes_ -= job.bytes;
  return job;
}

WorkerPool::Job WorkerPool::TakeNext() {
  const std::string peer = std::move(turns_.front());
  turns_.pop_front();
  const auto own = waiting_.find(peer);
  Job job = std::move(own->second.front());
  own->second.pop_front();
  if (own->second.empty()) {
    waiting_.erase(own);
  } else {
    turns_.push_back(peer);
  }
  --waiting_jobs_;
  waiting_bytes_ -= job.bytes;
  return job;
}

void WorkerPool::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

std::size_t WorkerPool::jobs() {
  const std::lock_guard lock(mutex_);
  return waiting_jobs_ + running_;
}

bool WorkerPool::WaitUntilIdle(Deadline deadline) {
  std::unique_lock lock(mutex_);
  return idle_.wait_until(lock, deadline, [this] { return waiting_jobs_ == 0 && running_ == 0; });
}

void WorkerPool::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    work_.wait(lock, [this] { return stopping_ || waiting_jobs_ > 0; });
    // A pool that stops first finishes what it has accepted.
    if (waiting_jobs_ == 0) return;
    const Job job = TakeNext();
    ++running_;
    lock.unlock();
    // A job answers its call and catches what that throws; here the thread is kept should the
    // answering itself throw.
    static_cast<void>(Caught([&] { return job.run(), Status::Ok(); }));
    lock.lock();
    --running_;
    if (waiting_jobs_ == 0 && running_ == 0) idle_.notify_all();
  }
}

}  // namespace maploc
