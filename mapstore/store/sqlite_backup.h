// Internal to mapstore/store: what backups and restores share.
#pragma once

#include <string>

#include "mapstore/base/status.h"
#include "mapstore/store/sqlite_database.h"

namespace maploc {

// All of `source`, as one state, into the new file `to`, with a stamp of its own. After a failure
// RemoveStoreFiles(to) is the caller's.
Status CopyStore(SqliteDatabase& source, const std::string& to);
// Makes new names in the file's folder outlive a crash. False: errno tells why.
bool SyncFolderOf(const std::string& path);
// Whether link() failed with `error` because the file system knows no second name for a file: vfat,
// exFAT and some network file systems.
bool HasNoLinks(int error);
// Renames a file, but replaces none. False: errno tells why, EEXIST where `to` is there already.
bool RenameToNewName(const std::string& from, const std::string& to);
// The same by any file system's means: takes the name first, then renames over it.
bool RenameOverOwnFile(const std::string& from, const std::string& to);

}  // namespace maploc
