#include "server/service/worker_pool.h"

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

WorkerPool::Admission WorkerPool::Submit(std::size_t bytes, std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return Admission::kClosed;
    if (jobs_.size() + running_ >= max_jobs_) return Admission::kFull;
    if (waiting_bytes_ + bytes > max_waiting_bytes_) return Admission::kFull;
    jobs_.push_back({bytes, std::move(job)});
    waiting_bytes_ += bytes;
  }
  work_.notify_one();
  return Admission::kAccepted;
}

void WorkerPool::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

bool WorkerPool::WaitUntilIdle(Deadline deadline) {
  std::unique_lock lock(mutex_);
  return idle_.wait_until(lock, deadline, [this] { return jobs_.empty() && running_ == 0; });
}

void WorkerPool::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    work_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    waiting_bytes_ -= job.bytes;
    ++running_;
    lock.unlock();
    static_cast<void>(Caught([&] { return job.run(), Status::Ok(); }));
    lock.lock();
    --running_;
    if (jobs_.empty() && running_ == 0) idle_.notify_all();
  }
}

}  // namespace maploc
