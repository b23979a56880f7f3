// Opening a store's file: is it ours, is it new enough, and the migrations that bring it up to
// date.
#pragma once

#include <string>

#include "mapstore/base/status.h"
#include "mapstore/store/sqlite_database.h"

namespace maploc {

struct SqliteStoreOptions;

// Whether there is a store that this program can open, judged by bytes alone: errors as
// OpenSqliteStore says, and nothing is touched.
Status CheckStoreFile(const std::string& path);

// The connection that writes, to a store of the current schema; where CanWriteStore says no, one
// that only reads (IsReadOnly). Errors as OpenSqliteStore says; a file that is refused has not been
// touched.
Result<SqliteDatabase> OpenStoreFile(const std::string& path, const SqliteStoreOptions& options);

}  // namespace maploc
