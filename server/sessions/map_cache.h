// Map versions in use, as immutable snapshots that queries share; their segments are in memory as
// far as the budget goes (segment_cache.h). A thread looks at the store's
// change counter each `poll_interval`: a new version, a pin or a decision, also of another process,
// is in force within a second. Nobody waits for a new version: the one before serves until it is
// loaded.
//
// Thread-safe.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/store/map_store.h"
#include "server/pipeline/map_snapshot.h"
#include "server/sessions/health.h"
#include "server/sessions/segment_cache.h"

namespace maploc {

struct MapCacheOptions {
  std::chrono::milliseconds poll_interval{500};
  // An old version that nobody asked for this long is dropped from memory.
  std::chrono::milliseconds keep_unused{std::chrono::minutes(10)};
  std::int64_t segment_bytes = std::numeric_limits<std::int64_t>::max();  // budget of segments
  Health* health = nullptr;  // outlives the cache; null: nobody asks, failures are logged alone
  // Called by the thread, at first and at changes: the store's maps, and of each whether it can be
  // opened, as far as anybody has tried.
  std::function<void(const std::map<std::string, bool>&)> tell_maps = {};
};

class MapCache {
 public:
  // Must not outlive the cache.
  using Snapshot = std::shared_ptr<const MapSnapshot>;

  // `store` must outlive the cache.
  explicit MapCache(const MapStore* store, const MapCacheOptions& options = {});
  ~MapCache();
  MapCache(const MapCache&) = delete;
  MapCache& operator=(const MapCache&) = delete;

  // The enabled version of a map, or while that one loads the one before. NOT_FOUND
  // (MAP_NOT_FOUND), DEADLINE_EXCEEDED where others load longer than the thread's WaitLimit, or the
  // store's errors.
  Result<Snapshot> Enabled(const std::string& name);
  // One version.
  Result<Snapshot> Get(const MapKey& key);

  // Sees at once what the store has committed; strategies alone, new versions come with the thread.
  Status Refresh();

  SegmentCacheState segment_state() { return segments_.state(); }

 private:
  struct Entry {
    Snapshot snapshot;
    std::chrono::steady_clock::time_point last_used;
  };

  void Run();
  Status LookAtChanges();
  Snapshot Find(const MapKey& key);
  Snapshot FindEnabled(const std::string& name);
  Result<Snapshot> Load(const MapKey& key);
  // What has changed since the store's counter was `since`. Drops the version where the store has
  // it no more, or has another content under its number.
  Status RefreshStrategies(const MapKey& key, std::int64_t since);
  void Drop(const MapKey& key);
  std::vector<MapKey> LoadedKeys() const;
  Result<Snapshot> LoadEnabled(const std::string& name);
  Result<Snapshot> FindAndLoad(const std::string& name);
  void NoteOpening(const std::string& name, const Status& status);
  Status ReadNames();
  void TellMaps();
  void SetEnabled(const MapKey& key);
  void LoadEnabledVersions();
  void DropUnused();

  const MapStore* const store_;
  const MapCacheOptions options_;
  Health own_health_;
  SegmentCache segments_;
  std::timed_mutex load_mutex_;       // one load at a time: two queries do not load one map twice
  std::mutex refresh_mutex_;          // one refresh at a time
  std::int64_t seen_counter_ = -1;    // guarded by refresh_mutex_
  std::int64_t versions_seen_ = -1;   // the counter at which the thread loaded enabled versions
  std::map<std::string, bool> told_;  // the thread's: what tell_maps has heard last

  mutable std::mutex mutex_;  // guards all below; never held over a call of the store
  std::map<MapKey, Entry> entries_;
  std::map<std::string, MapKey> enabled_;  // what Enabled serves; an entry is there for each
  std::set<std::string> names_;            // of the store's maps, at the thread's last look
  std::set<std::string> unusable_;         // of these
  std::condition_variable stop_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace maploc
