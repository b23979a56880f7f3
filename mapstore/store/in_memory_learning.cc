#include "mapstore/base/clock.h"
#include "mapstore/store/in_memory_data.h"
#include "mapstore/store/validation.h"

namespace maploc {

std::vector<TrueRow> InMemoryStore::RowsOf(const InMemoryMap& map, SegmentId id) const {
  std::vector<TrueRow> rows;
  for (const auto& [order, row] : map.segments[static_cast<std::size_t>(id)].rows) {
    const Session& session = sessions_.at(row.session).session;
    // The row of a revoked session stays, so that the revoke can be undone.
    if (!session.revoked) rows.push_back({row, session.map.version, session.end_unix_ns, 0});
  }
  return rows;
}

// All rows of this store are counted with the same options.
SegmentTruth InMemoryStore::TruthOf(const InMemoryMap& map, SegmentId id) const {
  std::vector<TrueRow> older;
  const std::vector<Inheritance> shares = SharesBehind(id, map.inheritance);
  for (const Inheritance& share : shares) {
    if (share.to != id) continue;
    const MapKey source{map.summary.info.key.name, share.source};
    for (TrueRow& row : RowsOf(maps_.at(source), share.from)) older.push_back(std::move(row));
  }
  SegmentTruth truth;
  truth.options = options_.selector;
  truth.pins = map.segments[static_cast<std::size_t>(id)].pins;
  for (TrueRow& row : WithInherited(id, RowsOf(map, id), older, shares)) {
    truth.rows.push_back(std::move(row.row));
    truth.ends_unix_ns.push_back(row.end_unix_ns);
  }
  return truth;
}

void InMemoryStore::Derive(InMemoryMap& map, SegmentId id) const {
  InMemorySegment& segment = map.segments[static_cast<std::size_t>(id)];
  segment.state = DeriveState(TruthOf(map, id));
  // The caller increments the counter afterwards, so this is the value that readers will see.
  segment.changed = change_counter_ + 1;
}

// The segments that the session saw, and those that inherit from them.
void InMemoryStore::DeriveVisited(const InMemorySession& session) {
  const MapKey& key = session.session.map;
  for (const SessionSummary::SegmentChange& visited : session.summary.segments) {
    Derive(maps_.at(key), visited.segment);
    for (auto& [other, map] : maps_) {
      if (other.name != key.name) continue;
      for (const Inheritance& share : map.inheritance) {
        if (share.source != key.version || share.from != visited.segment) continue;
        Derive(map, share.to);
      }
    }
  }
}

Status InMemoryStore::SetRevoked(const SessionId& id, bool revoked) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return UnknownSession(id);
  Session& session = found->second.session;
  if (session.revoked == revoked) return Status::Ok();
  session.revoked = revoked;
  DeriveVisited(found->second);
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
  InMemorySession& stored = found->second;
  if (stored.session.end != SessionEnd::kOpen) return stored.summary;
  // Every check comes before the first change, because this store cannot roll back.
  MAPLOC_RETURN_IF_ERROR(CheckObservations(stored.session, last));

  AddObservations(stored, last);
  const std::vector<Observation> observations = InOrder(stored.observations);
  const auto rows = FoldObservations(stored.session, observations);
  stored.summary = SummarizeSession(id, end, observations, rows);
  stored.session.end = end;
  stored.session.end_unix_ns = end_unix_ns;
  InMemoryMap& map = maps_.at(stored.session.map);
  const auto strategy_of = [&map](SegmentId segment) {
    return map.segments[static_cast<std::size_t>(segment)].state.derived.decision.strategy;
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    stored.summary.segments[i].strategy_before = strategy_of(rows[i].segment);
    map.segments[static_cast<std::size_t>(rows[i].segment)]
        .rows[{rows[i].session_start_unix_ns, id}] = rows[i];
  }
  DeriveVisited(stored);
  for (SessionSummary::SegmentChange& change : stored.summary.segments) {
    change.strategy_after = strategy_of(change.segment);
  }
  ++change_counter_;
  return stored.summary;
}

Result<SegmentTruth> InMemoryStore::FindTruth(const MapKey& key, SegmentId id) const {
  const std::lock_guard lock(mutex_);
  MAPLOC_RETURN_IF_ERROR(FindSegment(key, id).status());
  return TruthOf(maps_.at(key), id);
}

Result<std::vector<SegmentSessionRow>> InMemoryStore::ListRows(const MapKey& key,
                                                               SegmentId id) const {
  MAPLOC_ASSIGN_OR_RETURN(SegmentTruth truth, FindTruth(key, id));
  return std::move(truth.rows);
}

Result<std::vector<DecisionRecord>> InMemoryStore::ListDecisions(const MapKey& key,
                                                                 SegmentId id) const {
  MAPLOC_ASSIGN_OR_RETURN(const SegmentTruth truth, FindTruth(key, id));
  return ReplayHistory(truth);
}

Status InMemoryStore::PinStrategy(const MapKey& key, SegmentId id, std::optional<Strategy> pinned) {
  MAPLOC_RETURN_IF_ERROR(ValidatePin(pinned));
  const std::lock_guard lock(mutex_);
  MAPLOC_RETURN_IF_ERROR(FindSegment(key, id).status());
  InMemoryMap& map = maps_.at(key);
  InMemorySegment& segment = map.segments[static_cast<std::size_t>(id)];
  if (segment.state.pinned == pinned) return Status::Ok();
  segment.pins.push_back({SystemClock().NowUnixNanos(), pinned});
  Derive(map, id);
  ++change_counter_;
  return Status::Ok();
}

}  // namespace maploc
