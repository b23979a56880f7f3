#include "mapstore/store/sqlite_learning.h"

#include <set>
#include <utility>
#include <vector>

#include "mapstore/base/clock.h"
#include "mapstore/store/derivation.h"
#include "mapstore/store/sqlite_inheritance.h"
#include "mapstore/store/sqlite_maps.h"
#include "mapstore/store/sqlite_sessions.h"
#include "mapstore/store/sqlite_states.h"
#include "mapstore/store/validation.h"

namespace maploc {
namespace {

// One visited segment: its row, its statistics, its strategy. Fills in `change`'s strategies.
Status LearnSegment(SqliteDatabase& database, const StoredMap& map, const SegmentSessionRow& row,
                    const SelectorOptions& options, std::int64_t options_row,
                    SessionSummary::SegmentChange& change) {
  MAPLOC_ASSIGN_OR_RETURN(const SegmentState before,
                          ReadSegmentState(database, map.row_id, row.segment, options));
  MAPLOC_RETURN_IF_ERROR(InsertRow(database, map.row_id, row, options_row));
  MAPLOC_ASSIGN_OR_RETURN(const SegmentState after,
                          DeriveAnew(database, map.row_id, row.segment, options, PositionOf(row)));
  change.strategy_before = before.derived.decision.strategy;
  change.strategy_after = after.derived.decision.strategy;
  return KeepStrategies(database, map.row_id, row.session, change);
}

// The segments of newer versions that inherit from segments whose rows have changed. All rows are
// of one session, so they have one position in the folding order.
Status DeriveHeirs(SqliteDatabase& database, const StoredMap& map,
                   std::span<const SegmentSessionRow> changed, const SelectorOptions& options) {
  // A set: an heir of several of the session's segments is derived once.
  std::set<std::pair<std::int64_t, SegmentId>> heirs;
  for (const SegmentSessionRow& row : changed) {
    MAPLOC_ASSIGN_OR_RETURN(const auto of_segment, ReadHeirs(database, map.row_id, row.segment));
    heirs.insert(of_segment.begin(), of_segment.end());
  }
  for (const auto& [heir, segment] : heirs) {
    MAPLOC_RETURN_IF_ERROR(
        DeriveAnew(database, heir, segment, options, PositionOf(changed.front())).status());
  }
  return Status::Ok();
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
  // Read back, because most of them were appended during the session (AppendGroup).
  MAPLOC_ASSIGN_OR_RETURN(const auto observations, ReadObservations(database, id));
  const std::vector<SegmentSessionRow> rows = FoldObservations(session, observations);
  SessionSummary summary = SummarizeSession(id, end, observations, rows);
  MAPLOC_RETURN_IF_ERROR(CloseSession(database, summary, end_unix_ns));
  const SelectorOptions& options = connections.options().selector;
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t options_row, OptionsRow(database, options));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    MAPLOC_RETURN_IF_ERROR(
        LearnSegment(database, map, rows[i], options, options_row, summary.segments[i]));
  }
  // After all rows of the session, because an heir can inherit from several of its segments.
  MAPLOC_RETURN_IF_ERROR(DeriveHeirs(database, map, rows, options));
  MAPLOC_RETURN_IF_ERROR(writer.CommitVisibly());
  return summary;
}

Status SetSqliteSessionRevoked(SqliteConnections& connections, const SessionId& id, bool revoked) {
  MAPLOC_ASSIGN_OR_RETURN(auto writer, connections.Write());
  SqliteDatabase& database = writer.database();
  MAPLOC_ASSIGN_OR_RETURN(const Session session, ReadSession(database, id));
  if (session.revoked == revoked) return Status::Ok();
  // Unlike ReadMap this finds deleted versions: newer versions still inherit from their sessions.
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMapOfSession(database, session));
  MAPLOC_RETURN_IF_ERROR(MarkRevoked(database, id, revoked));
  MAPLOC_ASSIGN_OR_RETURN(const auto rows, ReadRowsOfSession(database, id));
  const SelectorOptions& options = connections.options().selector;
  for (const SegmentSessionRow& row : rows) {
    MAPLOC_RETURN_IF_ERROR(
        DeriveAnew(database, map.row_id, row.segment, options, PositionOf(row)).status());
  }
  MAPLOC_RETURN_IF_ERROR(DeriveHeirs(database, map, rows, options));
  return writer.CommitVisibly();
}

Status PinSqliteStrategy(SqliteConnections& connections, const MapKey& key, SegmentId id,
                         std::optional<Strategy> pinned) {
  MAPLOC_RETURN_IF_ERROR(ValidatePin(pinned));
  MAPLOC_ASSIGN_OR_RETURN(auto writer, connections.Write());
  SqliteDatabase& database = writer.database();
  MAPLOC_ASSIGN_OR_RETURN(const StoredMap map, ReadMap(database, key));
  MAPLOC_RETURN_IF_ERROR(RequireSegment(database, map, id));
  const SelectorOptions& options = connections.options().selector;
  MAPLOC_ASSIGN_OR_RETURN(const SegmentState state,
                          ReadSegmentState(database, map.row_id, id, options));
  if (state.pinned == pinned) return Status::Ok();
  MAPLOC_RETURN_IF_ERROR(
      InsertPin(database, map.row_id, id, {SystemClock().NowUnixNanos(), pinned}, options));
  MAPLOC_RETURN_IF_ERROR(DeriveAnew(database, map.row_id, id, options, AfterAllRows()).status());
  return writer.CommitVisibly();
}

}  // namespace maploc
