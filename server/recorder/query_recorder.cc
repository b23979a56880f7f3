#include "server/recorder/query_recorder.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>

#include <spdlog/spdlog.h>

#include "maploc/recording/v1/recording.pb.h"
#include "server/recorder/choice.h"
#include "server/recorder/recording_ring.h"

namespace maploc {
namespace {

using Steady = std::chrono::steady_clock;

// Three of the largest queries, or a hundred usual ones.
constexpr std::size_t kWaitingBytes = 64 << 20;
// A disk that failed is tried again after so long.
constexpr std::chrono::seconds kTryAgainAfter{1};
constexpr std::chrono::seconds kWriteOutTime{1};

struct Waiting {
  recording::v1::RecordedQuery query;
  std::size_t bytes = 0;
};

}  // namespace

struct QueryRecorder::Impl {
  Impl(RecordingRing used, int one_of)
      : ring(std::move(used)),
        every(one_of),
        bytes_on_disk(ring.bytes()),
        thread([this] { Run(); }) {}
  ~Impl() {
    {
      const std::lock_guard lock(mutex);
      stop_by = Steady::now() + kWriteOutTime;
    }
    changed.notify_all();
    thread.join();
  }

  bool IsChosen(Interest interest) {
    if (interest == Interest::kUsual) return usual++ % static_cast<std::uint64_t>(every) == 0;
    return interest == Interest::kUnusual;
  }

  // False: there is no room.
  bool Queue(Waiting&& waiting) {
    {
      const std::lock_guard lock(mutex);
      if (waiting_bytes + waiting.bytes > kWaitingBytes) return false;
      waiting_bytes += waiting.bytes;
      queue.push_back(std::move(waiting));
    }
    changed.notify_one();
    return true;
  }

  // The next one; none at the end.
  std::optional<Waiting> Take() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return !queue.empty() || stop_by; });
    if (queue.empty()) return std::nullopt;
    if (stop_by && Steady::now() > *stop_by) {
      lost += queue.size();
      return std::nullopt;
    }
    Waiting next = std::move(queue.front());
    queue.pop_front();
    waiting_bytes -= next.bytes;
    return next;
  }

  void Run() {
    while (std::optional<Waiting> next = Take()) {
      // Without memory a query is lost; the server goes on.
      try {
        Write(next->query);
      } catch (const std::exception&) {
        ++lost;
      }
    }
  }

  void Write(const recording::v1::RecordedQuery& query) {
    const Steady::time_point now = Steady::now();
    if (now < try_again) {
      ++lost;
      return;
    }
    bytes.clear();
    const Status status = query.SerializeToString(&bytes)
                              ? ring.Append(bytes)
                              : Internal("a query cannot be serialized");
    bytes_on_disk = ring.bytes();
    status.ok() ? ++recorded : ++lost;
    Tell(status);
    if (!status.ok()) try_again = now + kTryAgainAfter;
  }

  // Once when it begins to fail, or fails otherwise, and once when it goes on.
  void Tell(const Status& status) {
    if (status.reason() == told.reason()) return;
    if (status.ok()) {
      spdlog::info("queries are recorded again; {} were not since the start", lost.load());
    } else {
      spdlog::warn("queries are not recorded: {}", status.ToString());
    }
    told = status;
  }

  RecordingRing ring;  // the thread's
  const int every;
  std::atomic<std::uint64_t> usual = 0;
  std::atomic<std::size_t> recorded = 0;
  std::atomic<std::size_t> lost = 0;
  std::atomic<bool> told_full = false;
  std::atomic<std::int64_t> bytes_on_disk;
  std::string bytes;             // the thread's
  Status told;                   // the thread's: what the log has heard last
  Steady::time_point try_again;  // the thread's

  std::mutex mutex;  // guards all below
  std::condition_variable changed;
  std::deque<Waiting> queue;
  std::size_t waiting_bytes = 0;
  std::optional<Steady::time_point> stop_by;
  std::thread thread;  // last: it uses all the others
};

Result<std::unique_ptr<QueryRecorder>> QueryRecorder::Start(const RecorderOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(RecordingRing ring,
                          RecordingRing::Open(options.folder, options.max_bytes));
  spdlog::info("recording queries in {}", options.folder);
  return std::unique_ptr<QueryRecorder>(
      new QueryRecorder(std::make_unique<Impl>(std::move(ring), options.every)));
}

QueryRecorder::QueryRecorder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

QueryRecorder::~QueryRecorder() = default;

void QueryRecorder::Offer(recording::v1::RecordedQuery&& query) {
  Impl& recorder = *impl_;
  const Interest interest = InterestOf(query);
  if (!recorder.IsChosen(interest)) return;
  query.set_stands_for_count(interest == Interest::kUsual ? recorder.every : 1);
  const std::size_t bytes = query.ByteSizeLong();
  try {
    if (recorder.Queue({std::move(query), bytes})) return;
  } catch (const std::bad_alloc&) {
    // Its robot is to have its answer all the same.
  }
  ++recorder.lost;
  if (!recorder.told_full.exchange(true)) {
    spdlog::warn(
        "queries come faster than they can be recorded; maploc_recorder_lost_queries_total "
        "counts them");
  }
}

RecorderState QueryRecorder::state() const {
  return {impl_->bytes_on_disk, impl_->recorded, impl_->lost};
}

}  // namespace maploc
