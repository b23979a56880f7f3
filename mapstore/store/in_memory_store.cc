#include "mapstore/store/in_memory_store.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <tuple>

#include "mapstore/base/clock.h"
#include "mapstore/store/derivation.h"
#include "mapstore/store/in_memory_data.h"
#include "mapstore/store/validation.h"

namespace maploc {
namespace {

class InMemoryWriter : public MapWriter {
 public:
  InMemoryWriter(InMemoryStore& store, MapInfo info) : store_(store) {
    map_.summary.info = std::move(info);
    key_ = map_.summary.info.key;
  }
  ~InMemoryWriter() override {
    if (!committed_) store_.Abandon(key_);
  }

  const MapKey& key() const override { return key_; }

  Status AddSegment(const Segment& segment) override {
    if (committed_) return ImportCommitted();
    const auto next = static_cast<SegmentId>(map_.segments.size());
    MAPLOC_RETURN_IF_ERROR(ValidateNextSegment(map_.summary.info, segment, next));
    auto copy = std::make_shared<Segment>(segment);
    copy->map = key_;
    counter_.Add(segment);
    SegmentTruth nothing;
    nothing.options = store_.selector();
    map_.segments.push_back({std::move(copy), {}, {}, DeriveState(nothing)});
    return Status::Ok();
  }

  Status Commit(const Publishing& publishing) override {
    if (committed_) return ImportCommitted();
    if (map_.segments.empty()) return EmptyMap(key_);
    counter_.CountInto(map_.summary);
    store_.Publish(std::move(map_), publishing);
    committed_ = true;
    return Status::Ok();
  }

 private:
  InMemoryStore& store_;
  InMemoryMap map_;
  MapKey key_;
  LandmarkCounter counter_;
  bool committed_ = false;
};

}  // namespace

const InMemoryMap* InMemoryStore::FindPredecessor(const MapKey& heir) const {
  const InMemoryMap* predecessor = nullptr;
  // In ascending order of versions: the enabled one, else the newest before the heir.
  for (const auto& [key, map] : maps_) {
    if (key.name != heir.name || heir < key || map.deleted) continue;
    if (predecessor == nullptr || !predecessor->summary.enabled) predecessor = &map;
  }
  return predecessor;
}

void InMemoryStore::Enable(const MapKey& key) {
  std::int64_t last = 0;
  for (auto& [other, map] : maps_) {
    if (other.name != key.name) continue;
    map.summary.enabled = false;
    last = std::max(last, map.summary.enabled_order);
  }
  maps_.at(key).summary.enabled = true;
  maps_.at(key).summary.enabled_order = last + 1;
}

void InMemoryStore::Publish(InMemoryMap map, const Publishing& publishing) {
  const std::lock_guard lock(mutex_);
  const MapKey key = map.summary.info.key;
  imports_.erase(key);
  if (const InMemoryMap* predecessor = FindPredecessor(key)) {
    map.inheritance = InheritanceOf(map, *predecessor);
  }
  InMemoryMap& published = maps_.insert_or_assign(key, std::move(map)).first->second;
  for (const Inheritance& share : published.inheritance) Derive(published, share.to);
  // Of two imports at the same time the one that began later is newer, whichever ends first.
  const bool is_old = std::any_of(maps_.upper_bound(key), maps_.end(), [&](const auto& entry) {
    return entry.first.name == key.name && entry.second.summary.enabled;
  });
  if (publishing.enable && !is_old) Enable(key);
  DeleteOlder(key.name, publishing.keep_versions);
  ++change_counter_;
}

void InMemoryStore::Abandon(const MapKey& key) {
  const std::lock_guard lock(mutex_);
  imports_.erase(key);
}

Result<const InMemoryMap*> InMemoryStore::FindMap(const MapKey& key) const {
  const auto found = maps_.find(key);
  if (found == maps_.end() || found->second.deleted) return UnknownMap(key);
  return &found->second;
}

Result<const InMemorySegment*> InMemoryStore::FindSegment(const MapKey& key, SegmentId id) const {
  MAPLOC_ASSIGN_OR_RETURN(const InMemoryMap* map, FindMap(key));
  if (id < 0 || static_cast<std::size_t>(id) >= map->segments.size()) {
    return UnknownSegment(key, id);
  }
  return &map->segments[static_cast<std::size_t>(id)];
}

Result<std::vector<MapSummary>> InMemoryStore::ListMaps() const {
  const std::lock_guard lock(mutex_);
  std::vector<MapSummary> enabled;
  for (const auto& [key, map] : maps_) {
    if (map.summary.enabled) enabled.push_back(map.summary);
  }
  return enabled;
}

Result<std::vector<MapSummary>> InMemoryStore::ListVersions() const {
  const std::lock_guard lock(mutex_);
  std::vector<MapSummary> versions;
  for (const auto& [key, map] : maps_) {
    if (!map.deleted) versions.push_back(map.summary);
  }
  return versions;
}

Status InMemoryStore::EnableVersion(const MapKey& key, KeptVersions keep) {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const InMemoryMap* map, FindMap(key));
  if (map->summary.enabled && !keep) return Status::Ok();
  if (!map->summary.enabled) Enable(key);
  DeleteOlder(key.name, keep);
  ++change_counter_;
  return Status::Ok();
}

Status InMemoryStore::DeleteVersion(const MapKey& key) {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const InMemoryMap* found, FindMap(key));
  if (found->summary.enabled) return VersionEnabled(key);
  const std::int64_t open = CountOpenSessions(key);
  if (open > 0) return VersionInUse(key, open);
  Delete(maps_.at(key));
  ++change_counter_;
  return Status::Ok();
}

std::int64_t InMemoryStore::CountOpenSessions(const MapKey& key) const {
  return std::count_if(sessions_.begin(), sessions_.end(), [&](const auto& entry) {
    const Session& session = entry.second.session;
    return session.map == key && session.end == SessionEnd::kOpen;
  });
}

void InMemoryStore::Delete(InMemoryMap& map) {
  // Only the landmarks go. Rows and weights stay, because newer versions inherit from them.
  map.deleted = true;
  map.summary.enabled_order = 0;
  for (InMemorySegment& segment : map.segments) segment.segment = nullptr;
}

void InMemoryStore::DeleteOlder(const std::string& name, KeptVersions keep) {
  if (!keep) return;
  std::vector<InMemoryMap*> older;
  for (auto& [key, map] : maps_) {
    if (key.name != name || map.deleted) continue;
    if (map.summary.enabled) break;  // ascending by version
    older.push_back(&map);
  }
  const bool none_enabled = std::ranges::none_of(
      maps_, [&](const auto& e) { return e.first.name == name && e.second.summary.enabled; });
  if (none_enabled) return;
  std::ranges::sort(older, std::greater(), [](const InMemoryMap* map) {
    return std::pair(map->summary.enabled_order, map->summary.info.key.version);
  });
  for (std::size_t i = static_cast<std::size_t>(*keep); i < older.size(); ++i) {
    if (CountOpenSessions(older[i]->summary.info.key) == 0) Delete(*older[i]);
  }
}

Result<MapSummary> InMemoryStore::GetMap(const std::string& name) const {
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<MapSummary> maps, ListMaps());
  for (const MapSummary& map : maps) {
    if (map.info.key.name == name) return map;
  }
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<MapSummary> versions, ListVersions());
  const bool disabled = std::ranges::any_of(
      versions, [&name](const MapSummary& map) { return map.info.key.name == name; });
  return disabled ? NoVersionEnabled(name) : UnknownMap(name);
}

Result<MapSummary> InMemoryStore::GetMap(const MapKey& key) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const InMemoryMap* map, FindMap(key));
  return map->summary;
}

Result<std::vector<SegmentSummary>> InMemoryStore::ListSegments(const MapKey& key) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const InMemoryMap* map, FindMap(key));
  std::vector<SegmentSummary> segments;
  for (const InMemorySegment& segment : map->segments) segments.push_back(Summarize(segment));
  return segments;
}

Result<std::vector<SegmentSummary>> InMemoryStore::ListChangedSegments(const MapKey& key,
                                                                       std::int64_t since) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const InMemoryMap* map, FindMap(key));
  std::vector<SegmentSummary> segments;
  for (const InMemorySegment& segment : map->segments) {
    if (segment.changed > since) segments.push_back(Summarize(segment));
  }
  return segments;
}

Result<SegmentSummary> InMemoryStore::GetSegment(const MapKey& key, SegmentId id) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const InMemorySegment* segment, FindSegment(key, id));
  return Summarize(*segment);
}

Result<std::shared_ptr<const Segment>> InMemoryStore::LoadSegment(const MapKey& key,
                                                                  SegmentId id) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const InMemorySegment* segment, FindSegment(key, id));
  return segment->segment;
}

Result<std::vector<SegmentPlace>> InMemoryStore::LoadPlaces(const MapKey& key) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const InMemoryMap* map, FindMap(key));
  std::vector<SegmentPlace> places;
  for (const InMemorySegment& stored : map->segments) places.push_back(PlaceOf(*stored.segment));
  return places;
}

Result<std::unique_ptr<MapWriter>> InMemoryStore::BeginImport(const MapInfo& info) {
  MAPLOC_RETURN_IF_ERROR(ValidateMapInfo(info));
  const std::lock_guard lock(mutex_);
  MapInfo named = info;
  named.key.version = 1;
  // A deleted version keeps its entry, so that its number is never used again.
  while (maps_.contains(named.key) || imports_.contains(named.key)) ++named.key.version;
  imports_.insert(named.key);
  return std::unique_ptr<MapWriter>(std::make_unique<InMemoryWriter>(*this, std::move(named)));
}

Status InMemoryStore::StartSession(const Session& session) {
  MAPLOC_RETURN_IF_ERROR(ValidateNewSession(session));
  const std::lock_guard lock(mutex_);
  MAPLOC_RETURN_IF_ERROR(FindMap(session.map).status());
  Session fresh = session;
  fresh.end_unix_ns = 0;
  fresh.revoked = false;
  if (!sessions_.try_emplace(session.id, InMemorySession{std::move(fresh), {}, {}}).second) {
    return SessionExists(session.id);
  }
  return Status::Ok();
}

Result<Session> InMemoryStore::GetSession(const SessionId& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return UnknownSession(id);
  return found->second.session;
}

Result<std::vector<Session>> InMemoryStore::ListSessions() const {
  const std::lock_guard lock(mutex_);
  std::vector<Session> sessions;
  for (const auto& [id, stored] : sessions_) sessions.push_back(stored.session);
  std::sort(sessions.begin(), sessions.end(), [](const Session& a, const Session& b) {
    return std::tie(a.start_unix_ns, a.id) < std::tie(b.start_unix_ns, b.id);
  });
  return sessions;
}

Status InMemoryStore::CheckObservations(const Session& session,
                                        std::span<const Observation> observations) const {
  for (const Observation& observation : observations) {
    MAPLOC_RETURN_IF_ERROR(ValidateObservation(observation));
    if (observation.segment < 0) continue;
    MAPLOC_RETURN_IF_ERROR(FindSegment(session.map, observation.segment).status());
  }
  return Status::Ok();
}

Result<std::vector<SessionId>> InMemoryStore::AppendGroup(
    std::span<const SessionObservations> group) {
  const std::lock_guard lock(mutex_);
  std::vector<SessionId> ended;
  for (const auto& [id, observations] : group) {
    const auto found = sessions_.find(id);
    if (found == sessions_.end()) return UnknownSession(id);
    if (found->second.session.end != SessionEnd::kOpen) {
      ended.push_back(id);
      continue;
    }
    MAPLOC_RETURN_IF_ERROR(CheckObservations(found->second.session, observations));
  }
  // A second pass, because this store cannot roll back: an error in a later session must leave the
  // earlier ones unchanged.
  for (const auto& [id, observations] : group) {
    InMemorySession& stored = sessions_.at(id);
    if (stored.session.end != SessionEnd::kOpen) continue;
    AddObservations(stored, observations);
  }
  return ended;
}

Result<std::vector<Observation>> InMemoryStore::ListObservations(const SessionId& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return UnknownSession(id);
  return InOrder(found->second.observations);
}

Result<std::int64_t> InMemoryStore::ChangeCounter() const {
  const std::lock_guard lock(mutex_);
  return change_counter_;
}

Status InMemoryStore::Verify() const {
  const std::lock_guard lock(mutex_);
  for (const auto& [key, map] : maps_) {
    if (map.deleted) continue;
    for (const InMemorySegment& segment : map.segments) {
      MAPLOC_RETURN_IF_ERROR(ValidateSegment(map.summary.info, *segment.segment));
      if (DeriveState(TruthOf(map, segment.segment->id)) != segment.state) {
        return Status(StatusCode::kDataLoss, "DAMAGED_STORE",
                      "map '" + key.name + "' segment " + std::to_string(segment.segment->id) +
                          ": its statistics differ from its sessions' rows");
      }
    }
  }
  return Status::Ok();
}

std::unique_ptr<MapStore> NewInMemoryStore(const StoreOptions& options) {
  return std::make_unique<InMemoryStore>(options);
}

}  // namespace maploc
