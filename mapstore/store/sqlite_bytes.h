// A file's first bytes, as they lie there, without making it a database connection.
//
// Read by SQLite's own file layer, never by a descriptor of ours: POSIX lets go of all of a
// process's locks on a file as soon as the process closes any descriptor of it, so a look of ours
// would take the locks of the connections that this process has to the same store, and the next
// process would take itself for its last user and put the log away. SQLite knows which files it has
// locked and closes them later.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "mapstore/base/status.h"

namespace maploc {

// Fills `bytes`; zeros stand for what the file does not have. UNAVAILABLE (STORE_NOT_READABLE).
// Nothing is changed, and no lock is taken. Thread-safe.
Status ReadFirstBytes(const std::string& path, std::span<unsigned char> bytes);

}  // namespace maploc
