// A whole file in memory. Only for this folder.
#pragma once

#include <string>

#include "mapstore/base/status.h"

namespace maploc {

// NOT_FOUND (FILE_NOT_FOUND) for a missing one; INVALID_FILE for what is not a regular file or
// cannot be read to its end.
Result<std::string> ReadFileBytes(const std::string& path);

}  // namespace maploc
