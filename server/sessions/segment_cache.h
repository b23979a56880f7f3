// Segments in memory, of all map versions, within a budget of bytes. A segment is loaded when a
// query needs it, once for all that wait for it; beyond the budget those go first that nobody has
// needed for longest. Loading has threads of its own, so that whoever waits can give up.
//
// Thread-safe.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/store/map_store.h"
#include "server/pipeline/segment_source.h"

namespace maploc {

// Half of a store's readers (sqlite_connections.h): loads never keep sessions from reading.
inline constexpr int kLoadingThreads = 4;
// The reason where a version that is in use was deleted or replaced in the store.
inline constexpr char kMapMoves[] = "MAP_MOVES";

// What an operator watches of a cache.
struct SegmentCacheState {
  std::int64_t bytes = 0;  // of the segments in memory
  std::int64_t budget_bytes = 0;
  std::size_t hits = 0;       // since the start: segments that were in memory when needed
  std::size_t loads = 0;      // that were read from the store
  std::size_t evictions = 0;  // that left the memory for others
};

class SegmentCache {
 public:
  using SharedSegment = std::shared_ptr<const Segment>;

  // `store` must outlive the cache. Segments in use stay, and count, however small the budget.
  SegmentCache(const MapStore* store, std::int64_t budget_bytes);
  ~SegmentCache();
  SegmentCache(const SegmentCache&) = delete;
  SegmentCache& operator=(const SegmentCache&) = delete;

  // The segments of the version that the store has at present under this key. Those in memory go
  // with the source, which must not outlive the cache. Its errors are the store's, and UNAVAILABLE
  // (MAP_MOVES) where the store has the version no more.
  std::shared_ptr<const SegmentSource> Open(const MapInfo& version);

  SegmentCacheState state();

 private:
  class Source;
  using Key = std::pair<std::int64_t, SegmentId>;  // number of the source, segment
  struct Kept {
    SharedSegment segment;
    std::int64_t bytes = 0;
    std::list<Key>::iterator use;
  };
  struct Load {
    MapInfo version;
    int waiting = 0;
    bool done = false;
    Result<SharedSegment> result = SharedSegment();  // once done
  };

  Result<SharedSegment> Get(const Source& source, SegmentId id, const Interrupt& interrupt);
  void Forget(std::int64_t source);
  void Run();
  Result<SharedSegment> Read(const MapInfo& version, SegmentId id) const;
  // REQUIRES of these: mutex_ is held.
  void Finish(const Key& key, Load& load, Result<SharedSegment> result);
  SharedSegment FindKept(const Key& key);
  void Keep(const Key& key, const SharedSegment& segment);
  std::vector<SharedSegment> TakeBeyondBudget();

  const MapStore* const store_;
  const std::int64_t budget_bytes_;
  std::mutex mutex_;  // guards all below; never held over a call of the store
  std::condition_variable queued_;
  std::condition_variable loaded_;
  std::int64_t sources_ = 0;  // so many were opened
  std::set<std::int64_t> open_;
  std::map<Key, Kept> kept_;
  std::list<Key> uses_;  // of kept_, the latest first
  std::int64_t bytes_ = 0;
  std::size_t hits_ = 0;
  std::size_t reads_ = 0;
  std::size_t evictions_ = 0;
  std::map<Key, std::shared_ptr<Load>> loads_;  // queued or running
  std::deque<Key> queue_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

// In memory, with what it points to.
std::int64_t BytesOf(const Segment& segment);

}  // namespace maploc
