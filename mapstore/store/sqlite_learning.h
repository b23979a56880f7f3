// What changes statistics and strategies in SQLite: the end of a session, and a pin. Each is one
// transaction.
#pragma once

#include <optional>
#include <span>

#include "mapstore/store/map_store.h"
#include "mapstore/store/sqlite_connections.h"

namespace maploc {

Result<SessionSummary> EndSqliteSession(SqliteConnections& connections, const SessionId& id,
                                        SessionEnd end, std::int64_t end_unix_ns,
                                        std::span<const Observation> last);
Status PinSqliteStrategy(SqliteConnections& connections, const MapKey& key, SegmentId id,
                         std::optional<Strategy> pinned);

// Derives every segment's statistics and strategy from its rows, with the options that are in force
// for it; what differs becomes a decision with this cause. REQUIRES: a write transaction.
Status DeriveDecisionsAnew(SqliteDatabase& database, const std::string& cause);

}  // namespace maploc
