// A file that tells scripts the port which the system chose.
#pragma once

#include <string>

#include "mapstore/base/status.h"

namespace maploc {

// Atomically: a reader sees the whole number or no file. UNAVAILABLE (CANNOT_WRITE) with the path.
Status WritePortFile(const std::string& path, int port);
// No error where there is none.
void RemovePortFile(const std::string& path);

}  // namespace maploc
