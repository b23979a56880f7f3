// The store on disk: one SQLite file (FORMAT.md), shared by the running server and by maploc-map.
// Write-ahead logging, so readers never wait for a writer; a writer waits for another one.
#pragma once

#include <memory>
#include <string>

#include "mapstore/base/status.h"
#include "mapstore/store/map_store.h"

namespace maploc {

struct SqliteStoreOptions : StoreOptions {
  bool create = true;                    // a missing or empty file becomes a new store
  bool read_only = false;                // as where nothing may be written (CanWriteStore)
  bool sweep_abandoned_imports = false;  // at once; for a server's start
  int busy_timeout_ms = 10000;  // how long a writer waits for another process's transaction
};

// Errors name the file, and leave it unchanged:
// NOT_FOUND (STORE_NOT_FOUND) there is none and `create` is false;
// DATA_LOSS (INVALID_FILE) not SQLite, or another application's SQLite;
// FAILED_PRECONDITION (STORE_TOO_NEW) written by a newer maploc;
// DATA_LOSS truncated or damaged; UNAVAILABLE cannot be opened or locked.
Result<std::unique_ptr<MapStore>> OpenSqliteStore(const std::string& path,
                                                  const SqliteStoreOptions& options = {});

// The same errors, as far as the file's first bytes and its log tell, without touching anything; ok
// where a store could be made.
Status CheckStore(const std::string& path);

// Whether file and folder may be written by this process; true where there is no store yet. Where
// not, OpenSqliteStore opens a store to read: what would change it is FAILED_PRECONDITION
// (STORE_READ_ONLY), and a schema or derivation of another version STORE_TOO_OLD.
bool CanWriteStore(const std::string& path);

// Gives the closed store `partial` its name, for good; ALREADY_EXISTS (FILE_EXISTS) where there is
// such a file: nothing is replaced.
Status PublishStoreFile(const std::string& partial, const std::string& to);
// ALREADY_EXISTS (FILE_EXISTS) where there is a file, UNAVAILABLE where none can be made. Asked
// before the work, whose file has another name.
Status CheckNewStoreFile(const std::string& to);
// The file and what is kept beside it by SQLite and by imports; no error where there is none.
void RemoveStoreFiles(const std::string& path);

// Copies the store at `from` while it may be in use, as one consistent state. `to` must not exist;
// it appears only when complete.
Status BackupSqliteStore(const std::string& from, const std::string& to);

}  // namespace maploc
