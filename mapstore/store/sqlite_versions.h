// Which version of a map robots get, and the end of a version, in SQLite. map_store.h has the
// contract of each.
#pragma once

#include "mapstore/model/map.h"
#include "mapstore/store/map_store.h"
#include "mapstore/store/sqlite_connections.h"

namespace maploc {

Status EnableSqliteVersion(SqliteConnections& connections, const MapKey& key, KeptVersions keep);
Status DeleteSqliteVersion(SqliteConnections& connections, const MapKey& key);
// Deletes what is left of deleted versions after an interruption.
Status SweepDeletedVersions(SqliteConnections& connections);
// The same after a transaction that has marked versions as deleted, and gives their space back.
// What fails is done by the next one.
void FinishDeletions(SqliteConnections& connections);

// REQUIRES: a write transaction; the row is published in it.
Status EnableRow(SqliteDatabase& database, std::int64_t map);
// REQUIRES: a write transaction. Marks as deleted what `keep` (map_store.h) does not keep.
Status MarkOlderDeleted(SqliteDatabase& database, const std::string& name, KeptVersions keep);

}  // namespace maploc
