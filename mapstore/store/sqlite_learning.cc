#include "mapstore/store/sqlite_learning.h"

#include <vector>

#include "mapstore/base/clock.h"
#include "mapstore/store/derivation.h"
#include "mapstore/store/sqlite_decisions.h"
#include "mapstore/store/sqlite_maps.h"
#include "mapstore/store/sqlite_sessions.h"
#include "mapstore/store/validation.h"

namespace maploc {
namespace {

// One visited segment: its row, its statistics, its strategy. Fills in `change`'s strategies.
Status LearnSegment(SqliteDatabase& database, const StoredMap& map, const SegmentSessionRow& row,
                    const SelectorOptions& options, std::int64_t time_unix_ns,
                    SessionSummary::SegmentChange& change) {
  MAPLOC_ASSIGN_OR_RETURN(SegmentState state,
                          ReadSegmentState(database, map.row_id, row.segment, options));
  MAPLOC_ASSIGN_OR_RETURN(auto rows, ReadRows(database, map.row_id, row.segment));
  InsertInFoldingOrder(row, rows);
  change.strategy_before = state.derived.decision.strategy;
  state.options = options;
  state.derived = DeriveSegment(rows, state.pinned, options);
  change.strategy_after = state.derived.decision.strategy;
  MAPLOC_RETURN_IF_ERROR(InsertRow(database, map.row_id, row, change));
  return InsertDecision(database, map.row_id, row.segment, time_unix_ns, row.session, state);
}

}  // namespace

Result<SessionSummary> EndSqliteSession(SqliteConnections& connections, const SessionId& id,
                                        SessionEnd end, std::int64_t end_unix_ns,
                                        std::span<const Observation> last) {
  MAPLOC_RETURN_IF_ERROR(ValidateSessionEnd(end));
  MAPLOC_ASSIGN_OR_RETURN(auto writer, connections.Write());
  SqliteDatabase& database = writer.database();
  MAPLOC_ASSIGN_OR_RETURN(const Session session, ReadSession(database, id));
  if (session.end != SessionEnd::kOpen) return ReadSummary(database, session);

  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(database, session.map));
  MAPLOC_RETURN_IF_ERROR(InsertObservations(database, map, id, last));
  MAPLOC_ASSIGN_OR_RETURN(const auto observations, ReadObservations(database, id));
  const std::vector<SegmentSessionRow> rows = FoldObservations(session, observations);
  SessionSummary summary = SummarizeSession(id, end, observations, rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    MAPLOC_RETURN_IF_ERROR(LearnSegment(database, map, rows[i], connections.options().selector,
                                        end_unix_ns, summary.segments[i]));
  }
  MAPLOC_RETURN_IF_ERROR(CloseSession(database, summary, end_unix_ns));
  MAPLOC_RETURN_IF_ERROR(writer.CommitVisibly());
  return summary;
}

Status PinSqliteStrategy(SqliteConnections& connections, const MapKey& key, SegmentId id,
                         std::optional<Strategy> pinned) {
  MAPLOC_RETURN_IF_ERROR(ValidatePin(pinned));
  MAPLOC_ASSIGN_OR_RETURN(auto writer, connections.Write());
  SqliteDatabase& database = writer.database();
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(database, key));
  MAPLOC_RETURN_IF_ERROR(RequireSegment(database, map, id));
  MAPLOC_ASSIGN_OR_RETURN(SegmentState state, ReadSegmentState(database, map.row_id, id,
                                                               connections.options().selector));
  if (state.pinned == pinned) return Status::Ok();
  MAPLOC_ASSIGN_OR_RETURN(const auto rows, ReadRows(database, map.row_id, id));
  state.pinned = pinned;
  state.derived = DeriveSegment(rows, pinned, state.options);
  MAPLOC_RETURN_IF_ERROR(InsertDecision(database, map.row_id, id, SystemClock().NowUnixNanos(),
                                        pinned ? "pin" : "unpin", state));
  return writer.CommitVisibly();
}

Status DeriveDecisionsAnew(SqliteDatabase& database, const std::string& cause) {
  const std::int64_t now = SystemClock().NowUnixNanos();
  MAPLOC_ASSIGN_OR_RETURN(const auto maps, ReadAllMaps(database));
  for (const StoredMap& map : maps) {
    for (SegmentId id = 0; id < map.summary.segments; ++id) {
      MAPLOC_ASSIGN_OR_RETURN(SegmentState state,
                              ReadSegmentState(database, map.row_id, id, SelectorOptions{}));
      MAPLOC_ASSIGN_OR_RETURN(const auto rows, ReadRows(database, map.row_id, id));
      SegmentDerivation derived = DeriveSegment(rows, state.pinned, state.options);
      if (derived.statistics == state.derived.statistics &&
          derived.decision == state.derived.decision) {
        continue;
      }
      state.derived = std::move(derived);
      MAPLOC_RETURN_IF_ERROR(InsertDecision(database, map.row_id, id, now, cause, state));
    }
  }
  return Status::Ok();
}

}  // namespace maploc
