// Imports into SQLite, and what is left of dead ones.
#pragma once

#include <memory>

#include "mapstore/store/map_store.h"
#include "mapstore/store/sqlite_connections.h"

namespace maploc {

// REQUIRES: `connections` outlive the writer.
Result<std::unique_ptr<MapWriter>> BeginSqliteImport(SqliteConnections& connections,
                                                     const MapInfo& info);
Status SweepSqliteImports(SqliteConnections& connections);

}  // namespace maploc
