#include "mapstore/store/in_memory_store.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <tuple>

#include "mapstore/base/clock.h"
#include "mapstore/store/derivation.h"
#include "mapstore/store/validation.h"

namespace maploc {
namespace {

// A session's row with the options that its end was counted with.
struct StoredRow {
  SegmentSessionRow row;
  SelectorOptions options;
};

struct StoredSegment {
  std::shared_ptr<const Segment> segment;
  std::map<std::pair<std::int64_t, SessionId>, StoredRow> rows;  // in folding order, also revoked
  std::vector<Pin> pins;
  SelectorOptions pin_options;  // of the last pin
  SegmentState state;
};

struct StoredMap {
  MapSummary summary;
  std::vector<StoredSegment> segments;  // by id
};

struct StoredSession {
  Session session;
  std::map<std::int64_t, Observation> observations;  // by sequence
  SessionSummary summary;                            // once ended
};

std::vector<Observation> InOrder(const std::map<std::int64_t, Observation>& observations) {
  std::vector<Observation> ordered;
  for (const auto& [sequence, observation] : observations) ordered.push_back(observation);
  return ordered;
}

class InMemoryStore : public MapStore {
 public:
  explicit InMemoryStore(const StoreOptions& options) : options_(options) {}

  Result<std::vector<MapSummary>> ListMaps() const override;
  Result<MapSummary> GetMap(const std::string& name) const override;
  Result<MapSummary> GetMap(const MapKey& key) const override;
  Result<std::vector<SegmentSummary>> ListSegments(const MapKey& key) const override;
  Result<SegmentSummary> GetSegment(const MapKey& key, SegmentId id) const override;
  Result<std::shared_ptr<const Segment>> LoadSegment(const MapKey& key,
                                                     SegmentId id) const override;
  Result<std::unique_ptr<MapWriter>> BeginImport(const MapInfo& info) override;
  Status SweepAbandonedImports() override { return Status::Ok(); }
  Status StartSession(const Session& session) override;
  Result<Session> GetSession(const SessionId& id) const override;
  Result<std::vector<Session>> ListSessions() const override;
  Status AppendObservations(const SessionId& id,
                            std::span<const Observation> observations) override;
  Result<std::vector<SessionId>> AppendGroup(std::span<const SessionObservations> group) override;
  Result<std::vector<Observation>> ListObservations(const SessionId& id) const override;
  Result<SessionSummary> EndSession(const SessionId& id, SessionEnd end, std::int64_t end_unix_ns,
                                    std::span<const Observation> last) override;
  Status RevokeSession(const SessionId& id) override { return SetRevoked(id, true); }
  Status ReinstateSession(const SessionId& id) override { return SetRevoked(id, false); }
  Result<std::vector<SegmentSessionRow>> ListRows(const MapKey& key, SegmentId id) const override;
  Result<std::vector<DecisionRecord>> ListDecisions(const MapKey& key, SegmentId id) const override;
  Status PinStrategy(const MapKey& key, SegmentId id, std::optional<Strategy> pinned) override;
  Result<std::int64_t> ChangeCounter() const override;
  Status Verify() const override;

  // For the writer.
  void Publish(StoredMap map);
  void Abandon(const MapKey& key);
  const SelectorOptions& selector() const { return options_.selector; }

 private:
  // REQUIRES: mutex_ is held (all of them).
  Result<const StoredMap*> FindMap(const MapKey& key) const;
  Result<const StoredSegment*> FindSegment(const MapKey& key, SegmentId id) const;
  Status SetRevoked(const SessionId& id, bool revoked);
  Status CheckObservations(const Session& session, std::span<const Observation> observations) const;
  SegmentTruth TruthOf(const StoredSegment& segment) const;
  void Derive(StoredSegment& segment) const { segment.state = DeriveState(TruthOf(segment)); }

  const StoreOptions options_;
  mutable std::mutex mutex_;
  std::map<MapKey, StoredMap> maps_;
  std::set<MapKey> imports_;  // versions that are given but not published
  std::map<SessionId, StoredSession> sessions_;
  std::int64_t change_counter_ = 0;
};

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
    map_.segments.push_back({std::move(copy), {}, {}, {}, DeriveState(nothing)});
    return Status::Ok();
  }

  Status Commit() override {
    if (committed_) return ImportCommitted();
    if (map_.segments.empty()) return EmptyMap(key_);
    counter_.CountInto(map_.summary);
    store_.Publish(std::move(map_));
    committed_ = true;
    return Status::Ok();
  }

 private:
  InMemoryStore& store_;
  StoredMap map_;
  MapKey key_;
  LandmarkCounter counter_;
  bool committed_ = false;
};

SegmentSummary Summarize(const StoredSegment& stored) {
  const Segment& segment = *stored.segment;
  SegmentSummary summary;
  summary.id = segment.id;
  summary.points = segment.points.size();
  summary.lines = segment.lines.size();
  summary.usable_lines = CountUsableLines(segment.lines);
  summary.path_in_map = segment.path_in_map;
  summary.statistics = stored.state.derived.statistics;
  summary.decision = stored.state.derived.decision;
  summary.pinned = stored.state.pinned;
  summary.selector = stored.state.options;
  return summary;
}

void InMemoryStore::Publish(StoredMap map) {
  const std::lock_guard lock(mutex_);
  const MapKey key = map.summary.info.key;
  imports_.erase(key);
  maps_.insert_or_assign(key, std::move(map));
  ++change_counter_;
}

void InMemoryStore::Abandon(const MapKey& key) {
  const std::lock_guard lock(mutex_);
  imports_.erase(key);
}

Result<const StoredMap*> InMemoryStore::FindMap(const MapKey& key) const {
  const auto found = maps_.find(key);
  if (found == maps_.end()) return UnknownMap(key);
  return &found->second;
}

Result<const StoredSegment*> InMemoryStore::FindSegment(const MapKey& key, SegmentId id) const {
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap* map, FindMap(key));
  if (id < 0 || static_cast<std::size_t>(id) >= map->segments.size()) {
    return UnknownSegment(key, id);
  }
  return &map->segments[static_cast<std::size_t>(id)];
}

Result<std::vector<MapSummary>> InMemoryStore::ListMaps() const {
  const std::lock_guard lock(mutex_);
  std::vector<MapSummary> newest;
  for (const auto& [key, map] : maps_) {
    if (!newest.empty() && newest.back().info.key.name == key.name) newest.pop_back();
    newest.push_back(map.summary);
  }
  return newest;
}

Result<MapSummary> InMemoryStore::GetMap(const std::string& name) const {
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<MapSummary> maps, ListMaps());
  for (const MapSummary& map : maps) {
    if (map.info.key.name == name) return map;
  }
  return UnknownMap(name);
}

Result<MapSummary> InMemoryStore::GetMap(const MapKey& key) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap* map, FindMap(key));
  return map->summary;
}

Result<std::vector<SegmentSummary>> InMemoryStore::ListSegments(const MapKey& key) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap* map, FindMap(key));
  std::vector<SegmentSummary> segments;
  for (const StoredSegment& segment : map->segments) segments.push_back(Summarize(segment));
  return segments;
}

Result<SegmentSummary> InMemoryStore::GetSegment(const MapKey& key, SegmentId id) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const StoredSegment* segment, FindSegment(key, id));
  return Summarize(*segment);
}

Result<std::shared_ptr<const Segment>> InMemoryStore::LoadSegment(const MapKey& key,
                                                                  SegmentId id) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const StoredSegment* segment, FindSegment(key, id));
  return segment->segment;
}

Result<std::unique_ptr<MapWriter>> InMemoryStore::BeginImport(const MapInfo& info) {
  MAPLOC_RETURN_IF_ERROR(ValidateMapInfo(info));
  const std::lock_guard lock(mutex_);
  MapInfo named = info;
  named.key.version = 1;
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
  if (!sessions_.try_emplace(session.id, StoredSession{std::move(fresh), {}, {}}).second) {
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

Status InMemoryStore::AppendObservations(const SessionId& id,
                                         std::span<const Observation> observations) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return UnknownSession(id);
  StoredSession& stored = found->second;
  if (stored.session.end != SessionEnd::kOpen) return SessionClosed(id);
  MAPLOC_RETURN_IF_ERROR(CheckObservations(stored.session, observations));
  for (const Observation& o : observations) stored.observations.try_emplace(o.sequence, o);
  return Status::Ok();
}

Result<std::vector<SessionId>> InMemoryStore::AppendGroup(
    std::span<const SessionObservations> group) {
  const std::lock_guard lock(mutex_);
  std::vector<SessionId> ended;
  for (const auto& [id, observations] : group) {
    const auto found = sessions_.find(id);
    if (found == sessions_.end()) return UnknownSession(id);
    MAPLOC_RETURN_IF_ERROR(CheckObservations(found->second.session, observations));
    if (found->second.session.end != SessionEnd::kOpen) ended.push_back(id);
  }
  for (const auto& [id, observations] : group) {
    StoredSession& stored = sessions_.at(id);
    if (stored.session.end != SessionEnd::kOpen) continue;
    for (const Observation& o : observations) stored.observations.try_emplace(o.sequence, o);
  }
  return ended;
}

Result<std::vector<Observation>> InMemoryStore::ListObservations(const SessionId& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return UnknownSession(id);
  return InOrder(found->second.observations);
}

SegmentTruth InMemoryStore::TruthOf(const StoredSegment& segment) const {
  SegmentTruth truth;
  truth.options = segment.pins.empty() ? options_.selector : segment.pin_options;
  truth.pins = segment.pins;
  for (const auto& [order, stored] : segment.rows) {
    const Session& session = sessions_.at(stored.row.session).session;
    if (session.revoked) continue;
    truth.rows.push_back(stored.row);
    truth.ends_unix_ns.push_back(session.end_unix_ns);
    truth.options = stored.options;
  }
  return truth;
}

Status InMemoryStore::SetRevoked(const SessionId& id, bool revoked) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return UnknownSession(id);
  Session& session = found->second.session;
  if (session.revoked == revoked) return Status::Ok();
  session.revoked = revoked;
  StoredMap& map = maps_.at(session.map);
  for (const SessionSummary::SegmentChange& visited : found->second.summary.segments) {
    Derive(map.segments[static_cast<std::size_t>(visited.segment)]);
  }
  ++change_counter_;
  return Status::Ok();
}

Result<SessionSummary> InMemoryStore::EndSession(const SessionId& id, SessionEnd end,
                                                 std::int64_t end_unix_ns,
                                                 std::span<const Observation> last) {
  MAPLOC_RETURN_IF_ERROR(ValidateSessionEnd(end));
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return UnknownSession(id);
  StoredSession& stored = found->second;
  if (stored.session.end != SessionEnd::kOpen) return stored.summary;
  MAPLOC_RETURN_IF_ERROR(CheckObservations(stored.session, last));

  for (const Observation& o : last) stored.observations.try_emplace(o.sequence, o);
  const std::vector<Observation> observations = InOrder(stored.observations);
  const auto rows = FoldObservations(stored.session, observations);
  stored.summary = SummarizeSession(id, end, observations, rows);
  stored.session.end = end;
  stored.session.end_unix_ns = end_unix_ns;
  StoredMap& map = maps_.at(stored.session.map);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    StoredSegment& segment = map.segments[static_cast<std::size_t>(rows[i].segment)];
    SessionSummary::SegmentChange& change = stored.summary.segments[i];
    change.strategy_before = segment.state.derived.decision.strategy;
    segment.rows[{rows[i].session_start_unix_ns, id}] = {rows[i], options_.selector};
    Derive(segment);
    change.strategy_after = segment.state.derived.decision.strategy;
  }
  ++change_counter_;
  return stored.summary;
}

Result<std::vector<SegmentSessionRow>> InMemoryStore::ListRows(const MapKey& key,
                                                               SegmentId id) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const StoredSegment* segment, FindSegment(key, id));
  return TruthOf(*segment).rows;
}

Result<std::vector<DecisionRecord>> InMemoryStore::ListDecisions(const MapKey& key,
                                                                 SegmentId id) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_ASSIGN_OR_RETURN(const StoredSegment* segment, FindSegment(key, id));
  return ReplayHistory(TruthOf(*segment));
}

Status InMemoryStore::PinStrategy(const MapKey& key, SegmentId id, std::optional<Strategy> pinned) {
  MAPLOC_RETURN_IF_ERROR(ValidatePin(pinned));
  const std::lock_guard lock(mutex_);
  MAPLOC_RETURN_IF_ERROR(FindSegment(key, id).status());
  StoredSegment& segment = maps_.at(key).segments[static_cast<std::size_t>(id)];
  if (segment.state.pinned == pinned) return Status::Ok();
  segment.pins.push_back({SystemClock().NowUnixNanos(), pinned});
  segment.pin_options = options_.selector;
  Derive(segment);
  ++change_counter_;
  return Status::Ok();
}

Result<std::int64_t> InMemoryStore::ChangeCounter() const {
  const std::lock_guard lock(mutex_);
  return change_counter_;
}

Status InMemoryStore::Verify() const {
  const std::lock_guard lock(mutex_);
  for (const auto& [key, map] : maps_) {
    for (const StoredSegment& segment : map.segments) {
      MAPLOC_RETURN_IF_ERROR(ValidateSegment(map.summary.info, *segment.segment));
      if (DeriveState(TruthOf(segment)) != segment.state) {
        return Status(StatusCode::kDataLoss, "DAMAGED_STORE",
                      "map '" + key.name + "' segment " + std::to_string(segment.segment->id) +
                          ": its statistics differ from its sessions' rows");
      }
    }
  }
  return Status::Ok();
}

}  // namespace

std::unique_ptr<MapStore> NewInMemoryStore(const StoreOptions& options) {
  return std::make_unique<InMemoryStore>(options);
}

}  // namespace maploc
