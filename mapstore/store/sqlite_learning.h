// What changes statistics and strategies in SQLite: the end of a session, a revoke, a pin. Each is
// one transaction.
#pragma once

#include <optional>
#include <span>

#include "mapstore/store/map_store.h"
#include "mapstore/store/sqlite_connections.h"

namespace maploc {

Result<SessionSummary> EndSqliteSession(SqliteConnections& connections, const SessionId& id,
                                        SessionEnd end, std::int64_t end_unix_ns,
                                        std::span<const Observation> last);
// Revokes a session, or reinstates it.
Status SetSqliteSessionRevoked(SqliteConnections& connections, const SessionId& id, bool revoked);
Status PinSqliteStrategy(SqliteConnections& connections, const MapKey& key, SegmentId id,
                         std::optional<Strategy> pinned);

}  // namespace maploc
