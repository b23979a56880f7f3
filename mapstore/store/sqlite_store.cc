#include "mapstore/store/sqlite_store.h"

#include "mapstore/store/sqlite_connections.h"
#include "mapstore/store/sqlite_import.h"
#include "mapstore/store/sqlite_learning.h"
#include "mapstore/store/sqlite_maps.h"
#include "mapstore/store/sqlite_places.h"
#include "mapstore/store/sqlite_sessions.h"
#include "mapstore/store/sqlite_states.h"
#include "mapstore/store/sqlite_verify.h"
#include "mapstore/store/sqlite_versions.h"
#include "mapstore/store/validation.h"

namespace maploc {
namespace {

// Each method takes a connection and delegates; the connections do the guarding.
class SqliteStore : public MapStore {
 public:
  explicit SqliteStore(std::unique_ptr<SqliteConnections> connections)
      : connections_(std::move(connections)) {}

  Result<std::vector<MapSummary>> ListMaps() const override;
  Result<MapSummary> GetMap(const std::string& name) const override;
  Result<MapSummary> GetMap(const MapKey& key) const override;
  Result<std::vector<MapSummary>> ListVersions() const override;
  Status EnableVersion(const MapKey& key, KeptVersions keep) override;
  Status DeleteVersion(const MapKey& key) override;
  Result<std::vector<SegmentSummary>> ListSegments(const MapKey& key) const override;
  Result<std::vector<SegmentSummary>> ListChangedSegments(const MapKey& key,
                                                          std::int64_t since) const override;
  Result<SegmentSummary> GetSegment(const MapKey& key, SegmentId id) const override;
  Result<std::shared_ptr<const Segment>> LoadSegment(const MapKey& key,
                                                     SegmentId id) const override;
  Result<std::vector<SegmentPlace>> LoadPlaces(const MapKey& key) const override;
  Result<std::unique_ptr<MapWriter>> BeginImport(const MapInfo& info) override;
  Status SweepAbandonedImports() override;
  Status StartSession(const Session& session) override;
  Result<Session> GetSession(const SessionId& id) const override;
  Result<std::vector<Session>> ListSessions() const override;
  Result<std::vector<SessionId>> AppendGroup(std::span<const SessionObservations> group) override;
  Result<std::vector<Observation>> ListObservations(const SessionId& id) const override;
  Result<SessionSummary> EndSession(const SessionId& id, SessionEnd end, std::int64_t end_unix_ns,
                                    std::span<const Observation> last) override;
  Status RevokeSession(const SessionId& id) override;
  Status ReinstateSession(const SessionId& id) override;
  Result<std::vector<SegmentSessionRow>> ListRows(const MapKey& key, SegmentId id) const override;
  Result<std::vector<DecisionRecord>> ListDecisions(const MapKey& key, SegmentId id) const override;
  Status PinStrategy(const MapKey& key, SegmentId id, std::optional<Strategy> pinned) override;
  Result<std::int64_t> ChangeCounter() const override;
  bool read_only() const override { return connections_->read_only(); }
  Status CheckIdentity() const override { return connections_->CheckIdentity(); }
  Status Verify() const override;

 private:
  Result<SegmentTruth> TruthOf(const MapKey& key, SegmentId id) const;
  Result<SegmentSummary> ReadSummaryOf(SqliteDatabase& database, const StoredMap& map,
                                       SegmentId id) const;

  const std::unique_ptr<SqliteConnections> connections_;
};

Result<std::vector<MapSummary>> SqliteStore::ListMaps() const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(const auto maps, ReadAllMaps(reader.database()));
  std::vector<MapSummary> enabled;
  for (const StoredMap& map : maps) {
    if (map.summary.enabled) enabled.push_back(map.summary);
  }
  return enabled;
}

Result<std::vector<MapSummary>> SqliteStore::ListVersions() const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(const auto maps, ReadAllMaps(reader.database()));
  std::vector<MapSummary> versions;
  for (const StoredMap& map : maps) versions.push_back(map.summary);
  return versions;
}

Status SqliteStore::EnableVersion(const MapKey& key, KeptVersions keep) {
  return EnableSqliteVersion(*connections_, key, keep);
}

Status SqliteStore::DeleteVersion(const MapKey& key) {
  return DeleteSqliteVersion(*connections_, key);
}

Result<MapSummary> SqliteStore::GetMap(const std::string& name) const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(StoredMap map, ReadEnabledMap(reader.database(), name));
  return std::move(map.summary);
}

Result<MapSummary> SqliteStore::GetMap(const MapKey& key) const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(StoredMap map, ReadMap(reader.database(), key));
  return std::move(map.summary);
}

Result<SegmentSummary> SqliteStore::ReadSummaryOf(SqliteDatabase& database, const StoredMap& map,
                                                  SegmentId id) const {
  MAPLOC_ASSIGN_OR_RETURN(SegmentSummary summary, ReadSegmentCounts(database, map, id));
  MAPLOC_ASSIGN_OR_RETURN(SegmentState state, ReadSegmentState(database, map.row_id, id,
                                                               connections_->options().selector));
  summary.statistics = state.derived.statistics;
  summary.decision = std::move(state.derived.decision);
  summary.pinned = state.pinned;
  summary.selector = state.options;
  return summary;
}

Result<std::vector<SegmentSummary>> SqliteStore::ListSegments(const MapKey& key) const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(reader.database(), key));
  std::vector<SegmentSummary> segments;
  // All in the transaction of `reader`, so that the segments are of one state.
  for (std::int64_t id = 0; id < map.summary.segments; ++id) {
    MAPLOC_ASSIGN_OR_RETURN(SegmentSummary summary,
                            ReadSummaryOf(reader.database(), map, static_cast<SegmentId>(id)));
    segments.push_back(std::move(summary));
  }
  return segments;
}

Result<std::vector<SegmentSummary>> SqliteStore::ListChangedSegments(const MapKey& key,
                                                                     std::int64_t since) const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(reader.database(), key));
  MAPLOC_ASSIGN_OR_RETURN(const auto ids, ReadChanged(reader.database(), map.row_id, since));
  std::vector<SegmentSummary> segments;
  for (const SegmentId id : ids) {
    MAPLOC_ASSIGN_OR_RETURN(SegmentSummary summary, ReadSummaryOf(reader.database(), map, id));
    segments.push_back(std::move(summary));
  }
  return segments;
}

Result<SegmentSummary> SqliteStore::GetSegment(const MapKey& key, SegmentId id) const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(reader.database(), key));
  return ReadSummaryOf(reader.database(), map, id);
}

Result<std::shared_ptr<const Segment>> SqliteStore::LoadSegment(const MapKey& key,
                                                                SegmentId id) const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(reader.database(), key));
  return ReadSegment(reader.database(), map, id);
}

Result<std::vector<SegmentPlace>> SqliteStore::LoadPlaces(const MapKey& key) const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(reader.database(), key));
  return ReadPlaces(reader.database(), map);
}

Result<std::unique_ptr<MapWriter>> SqliteStore::BeginImport(const MapInfo& info) {
  return BeginSqliteImport(*connections_, info);
}

Status SqliteStore::SweepAbandonedImports() { return SweepSqliteImports(*connections_); }

Status SqliteStore::StartSession(const Session& session) {
  MAPLOC_RETURN_IF_ERROR(ValidateNewSession(session));
  MAPLOC_ASSIGN_OR_RETURN(auto writer, connections_->Write());
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(writer.database(), session.map));
  MAPLOC_RETURN_IF_ERROR(InsertSession(writer.database(), map, session));
  return writer.Commit();
}

Result<Session> SqliteStore::GetSession(const SessionId& id) const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  return ReadSession(reader.database(), id);
}

Result<std::vector<Session>> SqliteStore::ListSessions() const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  return ReadSessions(reader.database());
}

Result<std::vector<SessionId>> SqliteStore::AppendGroup(
    std::span<const SessionObservations> group) {
  MAPLOC_ASSIGN_OR_RETURN(auto writer, connections_->Write());
  std::vector<SessionId> ended;
  for (const auto& [id, observations] : group) {
    MAPLOC_ASSIGN_OR_RETURN(const Session session, ReadSession(writer.database(), id));
    // Skipped and reported: a session that another process has ended must not cost the others of
    // the group their observations.
    if (session.end != SessionEnd::kOpen) {
      ended.push_back(id);
      continue;
    }
    MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(writer.database(), session.map));
    MAPLOC_RETURN_IF_ERROR(InsertObservations(writer.database(), map, id, observations));
  }
  MAPLOC_RETURN_IF_ERROR(writer.Commit());
  return ended;
}

Result<std::vector<Observation>> SqliteStore::ListObservations(const SessionId& id) const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(const Session session, ReadSession(reader.database(), id));
  return ReadObservations(reader.database(), session.id);
}

Result<SessionSummary> SqliteStore::EndSession(const SessionId& id, SessionEnd end,
                                               std::int64_t end_unix_ns,
                                               std::span<const Observation> last) {
  return EndSqliteSession(*connections_, id, end, end_unix_ns, last);
}

Status SqliteStore::RevokeSession(const SessionId& id) {
  return SetSqliteSessionRevoked(*connections_, id, true);
}

Status SqliteStore::ReinstateSession(const SessionId& id) {
  return SetSqliteSessionRevoked(*connections_, id, false);
}

Result<SegmentTruth> SqliteStore::TruthOf(const MapKey& key, SegmentId id) const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(reader.database(), key));
  MAPLOC_RETURN_IF_ERROR(RequireSegment(reader.database(), map, id));
  return ReadTruth(reader.database(), map.row_id, id, connections_->options().selector);
}

Result<std::vector<SegmentSessionRow>> SqliteStore::ListRows(const MapKey& key,
                                                             SegmentId id) const {
  MAPLOC_ASSIGN_OR_RETURN(SegmentTruth truth, TruthOf(key, id));
  return std::move(truth.rows);
}

Result<std::vector<DecisionRecord>> SqliteStore::ListDecisions(const MapKey& key,
                                                               SegmentId id) const {
  MAPLOC_ASSIGN_OR_RETURN(const SegmentTruth truth, TruthOf(key, id));
  return ReplayHistory(truth);
}

Status SqliteStore::PinStrategy(const MapKey& key, SegmentId id, std::optional<Strategy> pinned) {
  return PinSqliteStrategy(*connections_, key, id, pinned);
}

Result<std::int64_t> SqliteStore::ChangeCounter() const {
  MAPLOC_ASSIGN_OR_RETURN(auto reader, connections_->Read());
  SqliteStatement statement(reader.database(),
                            "SELECT value FROM meta WHERE name = 'change_counter'");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Step());
  if (!found) return Internal(connections_->path() + ": the change counter is missing");
  return statement.Int("value");
}

Status SqliteStore::Verify() const { return VerifySqliteStore(*connections_); }

}  // namespace

Result<std::unique_ptr<MapStore>> OpenSqliteStore(const std::string& path,
                                                  const SqliteStoreOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(auto connections, SqliteConnections::Open(path, options));
  auto store = std::make_unique<SqliteStore>(std::move(connections));
  if (options.sweep_abandoned_imports && !store->read_only())
    MAPLOC_RETURN_IF_ERROR(store->SweepAbandonedImports());
  return std::unique_ptr<MapStore>(std::move(store));
}

}  // namespace maploc
