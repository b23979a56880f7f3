// The write-ahead log beside a store's file, judged before SQLite replays it.
#pragma once

#include <string>

#include "mapstore/base/status.h"

namespace maploc {

// FAILED_PRECONDITION (FOREIGN_LOG) where the log is not empty and belongs to another file, or to
// another state of this one: SQLite would replay it into this file and damage it. Ok where nothing
// can be said: the file or the log has no stamp (sqlite_stamp.h). Nothing is changed.
Status CheckLog(const std::string& path);

}  // namespace maploc
