#include "server/sessions/segment_cache.h"

#include <algorithm>
#include <chrono>

#include "server/sessions/caught.h"

namespace maploc {
namespace {

// How often whoever waits for a load looks whether its caller has gone or its time is up.
constexpr std::chrono::milliseconds kLook{10};

template <typename T>
std::int64_t BytesOf(const std::vector<T>& values) {
  return static_cast<std::int64_t>(values.capacity() * sizeof(T));
}

template <typename Landmarks>
std::int64_t BytesOfAll(const Landmarks& landmarks) {
  return BytesOf(landmarks.ids) + BytesOf(landmarks.viewing) +
         BytesOf(landmarks.descriptors.bytes) + BytesOf(landmarks.descriptor_landmark);
}

Status Moved(const MapInfo& version) {
  return Status(StatusCode::kUnavailable, kMapMoves,
                "map '" + version.key.name + "' was replaced while it was used; try again");
}

}  // namespace

std::int64_t BytesOf(const Segment& segment) {
  return static_cast<std::int64_t>(sizeof(Segment)) + BytesOf(segment.path_in_map) +
         BytesOfAll(segment.points) + BytesOf(segment.points.positions_in_map) +
         BytesOfAll(segment.lines) + BytesOf(segment.lines.segments_in_map);
}

class SegmentCache::Source final : public SegmentSource {
 public:
  Source(SegmentCache* cache, std::int64_t number, const MapInfo& version)
      : cache_(cache), number_(number), version_(version) {}
  ~Source() override { cache_->Forget(number_); }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  Result<SharedSegment> Get(SegmentId id, const Interrupt& interrupt) const override {
    return cache_->Get(*this, id, interrupt);
  }
  std::int64_t number() const { return number_; }
  const MapInfo& version() const { return version_; }

 private:
  SegmentCache* const cache_;
  const std::int64_t number_;
  const MapInfo version_;
};

SegmentCache::SegmentCache(const MapStore* store, std::int64_t budget_bytes)
    : store_(store), budget_bytes_(budget_bytes) {
  for (int i = 0; i < kLoadingThreads; ++i) threads_.emplace_back([this] { Run(); });
}

SegmentCache::~SegmentCache() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  queued_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

std::shared_ptr<const SegmentSource> SegmentCache::Open(const MapInfo& version) {
  const std::lock_guard lock(mutex_);
  open_.insert(++sources_);
  return std::make_shared<const Source>(this, sources_, version);
}

SegmentCacheState SegmentCache::state() {
  const std::lock_guard lock(mutex_);
  return {bytes_, budget_bytes_, hits_, reads_, evictions_};
}

// The source is in use, so it is not forgotten meanwhile.
Result<SegmentCache::SharedSegment> SegmentCache::Get(const Source& source, SegmentId id,
                                                      const Interrupt& interrupt) {
  const Key key(source.number(), id);
  // Declared before the lock, so that nobody waits for it while segments are freed.
  std::vector<SharedSegment> freed;
  std::unique_lock lock(mutex_);
  freed = TakeBeyondBudget();  // what queries have let go since
  if (SharedSegment kept = FindKept(key)) {
    ++hits_;
    return kept;
  }
  std::shared_ptr<Load>& running = loads_[key];
  if (running == nullptr) {
    running = std::make_shared<Load>();
    running->version = source.version();
    queue_.push_back(key);
    queued_.notify_one();
  }
  const std::shared_ptr<Load> load = running;
  ++load->waiting;
  Status status;
  while (!load->done && (status = interrupt.Check()).ok()) {
    loaded_.wait_for(lock, kLook);
  }
  --load->waiting;
  return load->done ? load->result : status;
}

SegmentCache::SharedSegment SegmentCache::FindKept(const Key& key) {
  const auto found = kept_.find(key);
  if (found == kept_.end()) return nullptr;
  uses_.splice(uses_.begin(), uses_, found->second.use);
  return found->second.segment;
}

void SegmentCache::Keep(const Key& key, const SharedSegment& segment) {
  const std::int64_t bytes = BytesOf(*segment);
  uses_.push_front(key);
  kept_[key] = {segment, bytes, uses_.begin()};
  bytes_ += bytes;
}

// Those in use stay: to let them go would free nothing, and the next query would load them twice.
// Their count of uses cannot rise meanwhile, because only this class gives them out.
std::vector<SegmentCache::SharedSegment> SegmentCache::TakeBeyondBudget() {
  std::vector<SharedSegment> taken;
  for (auto use = uses_.end(); bytes_ > budget_bytes_ && use != uses_.begin();) {
    --use;
    const auto kept = kept_.find(*use);
    if (kept->second.segment.use_count() > 1) continue;
    bytes_ -= kept->second.bytes;
    taken.push_back(std::move(kept->second.segment));
    kept_.erase(kept);
    use = uses_.erase(use);
    ++evictions_;
  }
  return taken;
}

void SegmentCache::Forget(std::int64_t source) {
  std::vector<SharedSegment> freed;  // after the lock
  const std::lock_guard lock(mutex_);
  open_.erase(source);
  const auto begin = kept_.lower_bound({source, 0});
  auto end = begin;
  for (; end != kept_.end() && end->first.first == source; ++end) {
    bytes_ -= end->second.bytes;
    freed.push_back(std::move(end->second.segment));
    uses_.erase(end->second.use);
  }
  kept_.erase(begin, end);
}

// A version may be deleted and its number given to another import between two calls of the store,
// but it never comes back: what is there after the read was there before.
Result<SegmentCache::SharedSegment> SegmentCache::Read(const MapInfo& version, SegmentId id) const {
  Result<SharedSegment> segment = store_->LoadSegment(version.key, id);
  const Result<MapSummary> now = store_->GetMap(version.key);
  if (now.status().code() == StatusCode::kNotFound) return Moved(version);
  if (!now.ok()) return now.status();
  if (now->info.created_unix_ns != version.created_unix_ns) return Moved(version);
  return segment;
}

void SegmentCache::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    queued_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (stopping_) return;
    const Key key = queue_.front();
    queue_.pop_front();
    std::shared_ptr<Load> load = loads_.at(key);
    if (load->waiting > 0) {
      lock.unlock();
      Result<SharedSegment> result = Caught([&] { return Read(load->version, key.second); });
      lock.lock();
      Finish(key, *load, std::move(result));
    }
    loads_.erase(key);
    load.reset();  // its result would count as in use
    std::vector<SharedSegment> freed = TakeBeyondBudget();
    lock.unlock();
    loaded_.notify_all();
    freed.clear();
    lock.lock();
  }
}

// Kept, too, if those who waited have given up: others come.
void SegmentCache::Finish(const Key& key, Load& load, Result<SharedSegment> result) {
  ++reads_;
  if (result.ok() && open_.contains(key.first)) Keep(key, *result);
  load.result = std::move(result);
  load.done = true;
}

}  // namespace maploc
