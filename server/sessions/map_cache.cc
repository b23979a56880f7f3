#include "server/sessions/map_cache.h"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "mapstore/base/wait_limit.h"
#include "server/sessions/open_version.h"

namespace maploc {
namespace {

Status MapNotFound(const Status& status, const std::string& name) {
  if (status.code() != StatusCode::kNotFound) return status;
  return NotFound("map '" + name + "'", "MAP_NOT_FOUND");
}

// Whether the version in memory is the one that the store has under its number: a version that was
// deleted gives its number to the next import.
bool IsSameVersion(const MapSnapshot& loaded, const MapSummary& stored) {
  return loaded.info.created_unix_ns == stored.info.created_unix_ns &&
         static_cast<std::int64_t>(loaded.decisions.size()) == stored.segments;
}

bool AreSegmentsOf(const MapSnapshot& map, const std::vector<SegmentSummary>& segments) {
  return std::ranges::all_of(segments, [&map](const SegmentSummary& summary) {
    return summary.id < static_cast<SegmentId>(map.decisions.size());
  });
}

// The same map with the strategies of these segments; the same pointer where nothing differs.
// REQUIRES: they are segments of the map.
MapCache::Snapshot WithStrategies(const MapCache::Snapshot& old,
                                  const std::vector<SegmentSummary>& segments) {
  const auto is_as_it_was = [&old](const SegmentSummary& summary) {
    return old->decisions.at(summary.id) == summary.decision;
  };
  if (std::ranges::all_of(segments, is_as_it_was)) return old;
  auto changed = std::make_shared<MapSnapshot>(*old);
  for (const SegmentSummary& summary : segments) {
    changed->decisions.at(summary.id) = summary.decision;
  }
  return changed;
}

}  // namespace

MapCache::MapCache(const MapStore* store, const MapCacheOptions& options)
    : store_(store),
      options_(options),
      segments_(store, options.segment_bytes),
      thread_([this] { Run(); }) {}

MapCache::~MapCache() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stop_.notify_all();
  thread_.join();
}

Result<MapCache::Snapshot> MapCache::Enabled(const std::string& name) {
  if (Snapshot found = FindEnabled(name)) return found;
  return LoadEnabled(name);
}

Result<MapCache::Snapshot> MapCache::LoadEnabled(const std::string& name) {
  Result<Snapshot> loaded = FindAndLoad(name);
  NoteOpening(name, loaded.status());
  return loaded;
}

// A store that is busy or a deadline that has passed says nothing about the map.
void MapCache::NoteOpening(const std::string& name, const Status& status) {
  const std::lock_guard lock(mutex_);
  if (status.ok()) {
    unusable_.erase(name);
  } else if (status.code() == StatusCode::kDataLoss || status.code() == StatusCode::kInternal) {
    if (names_.contains(name)) unusable_.insert(name);
  }
}

// A version that is enabled while another one loads found no entry of the map to renew, so the
// store is asked again once the entry is there.
Result<MapCache::Snapshot> MapCache::FindAndLoad(const std::string& name) {
  Snapshot snapshot;
  while (true) {
    const Result<MapSummary> map = store_->GetMap(name);
    if (!map.ok()) return MapNotFound(map.status(), name);
    if (snapshot != nullptr && snapshot->info.key == map->info.key) return snapshot;
    MAPLOC_ASSIGN_OR_RETURN(snapshot, Get(map->info.key));
    SetEnabled(map->info.key);
  }
}

void MapCache::SetEnabled(const MapKey& key) {
  const std::lock_guard lock(mutex_);
  enabled_.insert_or_assign(key.name, key);
}

Result<MapCache::Snapshot> MapCache::Get(const MapKey& key) {
  if (Snapshot found = Find(key)) return found;
  // Whoever held the lock may have loaded this version: it is looked for again, also if the time is
  // up.
  const std::unique_lock load_lock(load_mutex_, WaitLimit::CurrentDeadline());
  if (Snapshot found = Find(key)) return found;
  if (!load_lock) {
    return Status(StatusCode::kDeadlineExceeded, "DEADLINE_EXCEEDED",
                  "the deadline passed while a map was opened; try again");
  }
  return Load(key);
}

MapCache::Snapshot MapCache::Find(const MapKey& key) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(key);
  if (found == entries_.end()) return nullptr;
  found->second.last_used = std::chrono::steady_clock::now();
  return found->second.snapshot;
}

MapCache::Snapshot MapCache::FindEnabled(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto enabled = enabled_.find(name);
  if (enabled == enabled_.end()) return nullptr;
  const auto found = entries_.find(enabled->second);
  if (found == entries_.end()) return nullptr;
  found->second.last_used = std::chrono::steady_clock::now();
  return found->second.snapshot;
}

Result<MapCache::Snapshot> MapCache::Load(const MapKey& key) {
  // Read first: what is committed during the load has a higher one, and is fetched below.
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t counter, store_->ChangeCounter());
  const Result<MapSummary> map = store_->GetMap(key);
  if (!map.ok()) return MapNotFound(map.status(), key.name);
  MAPLOC_ASSIGN_OR_RETURN(Snapshot snapshot, OpenVersion(*store_, map->info, segments_));
  spdlog::info("map '{}' version {} is open: {} segments, {} points, {} lines", key.name,
               key.version, map->segments, map->points, map->lines);
  {
    const std::lock_guard lock(mutex_);
    entries_[key] = {snapshot, std::chrono::steady_clock::now()};
  }
  // A decision that was made while this loaded found no entry to change.
  const std::lock_guard refresh_lock(refresh_mutex_);
  MAPLOC_RETURN_IF_ERROR(RefreshStrategies(key, counter));
  if (Snapshot found = Find(key)) return found;
  return Status(StatusCode::kUnavailable, kMapMoves,
                "map '" + key.name + "' was replaced while it was loaded; try again");
}

Status MapCache::RefreshStrategies(const MapKey& key, std::int64_t since) {
  const Result<MapSummary> map = store_->GetMap(key);
  if (map.status().code() == StatusCode::kNotFound) return Drop(key), Status::Ok();
  if (!map.ok()) return map.status();
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<SegmentSummary> changed,
                          store_->ListChangedSegments(key, since));
  {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key);
    if (found == entries_.end()) return Status::Ok();
    Snapshot& snapshot = found->second.snapshot;
    // Between two calls of the store the version may become another one.
    if (IsSameVersion(*snapshot, *map) && AreSegmentsOf(*snapshot, changed)) {
      snapshot = WithStrategies(snapshot, changed);
      return Status::Ok();
    }
  }
  return Drop(key), Status::Ok();
}

// The next one who asks loads what the store has by then.
void MapCache::Drop(const MapKey& key) {
  const std::lock_guard lock(mutex_);
  entries_.erase(key);
  const auto enabled = enabled_.find(key.name);
  if (enabled != enabled_.end() && enabled->second == key) enabled_.erase(enabled);
  spdlog::warn("map '{}' version {} was deleted or replaced in the store: dropped from memory",
               key.name, key.version);
}

Status MapCache::Refresh() {
  const std::lock_guard refresh_lock(refresh_mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t counter, store_->ChangeCounter());
  // Read before the segments: what is committed meanwhile is seen again in the next round.
  // seen_counter_ moves only when every map was refreshed.
  if (counter == seen_counter_) return Status::Ok();
  for (const MapKey& key : LoadedKeys()) {
    MAPLOC_RETURN_IF_ERROR(RefreshStrategies(key, seen_counter_));
  }
  seen_counter_ = counter;
  return Status::Ok();
}

std::vector<MapKey> MapCache::LoadedKeys() const {
  const std::lock_guard lock(mutex_);
  std::vector<MapKey> keys;
  for (const auto& [key, entry] : entries_) keys.push_back(key);
  return keys;
}

void MapCache::LoadEnabledVersions() {
  std::vector<std::string> names;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, key] : enabled_) names.push_back(name);
  }
  for (const std::string& name : names) {
    const Status status = LoadEnabled(name).status();
    // Deleted since: RefreshStrategies drops it.
    if (status.reason() == "MAP_NOT_FOUND") continue;
    if (!status.ok()) spdlog::error("map '{}' cannot be loaded: {}", name, status.ToString());
  }
}

void MapCache::DropUnused() {
  const auto oldest = std::chrono::steady_clock::now() - options_.keep_unused;
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&](const auto& entry) {
    const auto enabled = enabled_.find(entry.first.name);
    const bool serves = enabled != enabled_.end() && enabled->second == entry.first;
    return !serves && entry.second.last_used < oldest;
  });
}

Status MapCache::ReadNames() {
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<MapSummary> maps, store_->ListMaps());
  const std::lock_guard lock(mutex_);
  names_.clear();
  for (const MapSummary& map : maps) names_.insert(map.info.key.name);
  std::erase_if(unusable_, [this](const std::string& name) { return !names_.contains(name); });
  return Status::Ok();
}

void MapCache::TellMaps() {
  if (!options_.tell_maps) return;
  std::map<std::string, bool> maps;
  {
    const std::lock_guard lock(mutex_);
    for (const std::string& name : names_) maps[name] = !unusable_.contains(name);
  }
  if (maps == told_) return;
  told_ = std::move(maps);
  options_.tell_maps(told_);
}

Status MapCache::LookAtChanges() {
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t counter, store_->ChangeCounter());
  const Status refreshed = Refresh();
  if (counter != versions_seen_) {
    MAPLOC_RETURN_IF_ERROR(ReadNames());
    LoadEnabledVersions();
  }
  versions_seen_ = counter;
  TellMaps();
  DropUnused();
  return refreshed;
}

void MapCache::Run() {
  Health& health = options_.health != nullptr ? *options_.health : own_health_;
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    lock.unlock();
    health.Run("the store's changes", [this] { return LookAtChanges(); });
    lock.lock();
    stop_.wait_for(lock, options_.poll_interval, [this] { return stopping_; });
  }
}

}  // namespace maploc
