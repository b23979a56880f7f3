// Sessions, observations and rows in SQLite. Callers hold the connection, and a transaction around
// what belongs together.
#pragma once

#include <span>
#include <vector>

#include "mapstore/store/carried.h"
#include "mapstore/store/map_store.h"
#include "mapstore/store/sqlite_database.h"
#include "mapstore/store/sqlite_maps.h"

namespace maploc {

Status InsertSession(SqliteDatabase& database, const StoredMap& map, const Session& session);
Result<Session> ReadSession(SqliteDatabase& database, const SessionId& id);
Result<std::vector<Session>> ReadSessions(SqliteDatabase& database);  // by start, then id
// Marks the end, with the summary's totals.
Status CloseSession(SqliteDatabase& database, const SessionSummary& summary,
                    std::int64_t end_unix_ns);
// The kept summary of a closed session.
Result<SessionSummary> ReadSummary(SqliteDatabase& database, const Session& session);

// Validates each, and that its segment is in `map`; known sequences are left alone.
Status InsertObservations(SqliteDatabase& database, const StoredMap& map, const SessionId& id,
                          std::span<const Observation> observations);
Result<std::vector<Observation>> ReadObservations(SqliteDatabase& database, const SessionId& id);

// Whether the session counts. (Its rows stay.)
Status MarkRevoked(SqliteDatabase& database, const SessionId& id, bool revoked);

// The strategies before and after it are filled in by KeepStrategies.
Status InsertRow(SqliteDatabase& database, std::int64_t map, const SegmentSessionRow& row,
                 std::int64_t options);
// The strategies of a segment before and after a session's end, for its kept summary.
Status KeepStrategies(SqliteDatabase& database, std::int64_t map, const SessionId& id,
                      const SessionSummary::SegmentChange& change);
// Of unrevoked sessions on this version, in folding order; those after `after`.
Result<std::vector<TrueRow>> ReadRows(SqliteDatabase& database, std::int64_t map, SegmentId id,
                                      const FoldPosition& after);
// Of one session, by segment.
Result<std::vector<SegmentSessionRow>> ReadRowsOfSession(SqliteDatabase& database,
                                                         const SessionId& id);

}  // namespace maploc
