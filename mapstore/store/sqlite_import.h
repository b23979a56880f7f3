// Imports into SQLite, and what is left of dead ones.
#pragma once

#include <cstdint>
#include <memory>

#include "mapstore/store/map_store.h"
#include "mapstore/store/sqlite_connections.h"

namespace maploc {

// REQUIRES: `connections` outlive the writer.
Result<std::unique_ptr<MapWriter>> BeginSqliteImport(SqliteConnections& connections,
                                                     const MapInfo& info);
// Deletes what is left of the import with this row, unless it is published or alive by now.
Status SweepSqliteImport(SqliteConnections& connections, std::int64_t map);
// The same for every unpublished one.
Status SweepSqliteImports(SqliteConnections& connections);

}  // namespace maploc
