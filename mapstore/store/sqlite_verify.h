// Reads a whole store and checks every invariant of it.
#pragma once

#include "mapstore/base/status.h"
#include "mapstore/store/sqlite_connections.h"

namespace maploc {

// DATA_LOSS names what is broken first.
Status VerifySqliteStore(SqliteConnections& connections);

}  // namespace maploc
