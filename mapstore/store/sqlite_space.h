// The space of deleted rows back to the disk.
#pragma once

#include "mapstore/base/status.h"
#include "mapstore/store/sqlite_connections.h"

namespace maploc {

// In stores that SQLite can shrink a page at a time (auto_vacuum = INCREMENTAL), moves what stands
// at the file's end into its free pages, one short transaction after the other, and cuts the file.
// In others (MakeShrinkable failed) the space serves later writes, as before.
Status GiveSpaceBack(SqliteConnections& connections);

// For a store that was made before schema version 10, while nobody else has it open. Rewrites the
// file, so that it takes as much room again for a moment. A failure leaves the store as it was.
void MakeShrinkable(SqliteDatabase& database);

}  // namespace maploc
