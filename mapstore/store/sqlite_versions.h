// Which version of a map robots get, and the end of a version, in SQLite. map_store.h has the
// contract of each.
#pragma once

#include "mapstore/model/map.h"
#include "mapstore/store/sqlite_connections.h"

namespace maploc {

Status EnableSqliteVersion(SqliteConnections& connections, const MapKey& key);
Status DeleteSqliteVersion(SqliteConnections& connections, const MapKey& key);
// Deletes what is left of deleted versions after an interruption.
Status SweepDeletedVersions(SqliteConnections& connections);

// REQUIRES: a write transaction; the row is published in it.
Status EnableRow(SqliteDatabase& database, std::int64_t map);

}  // namespace maploc
