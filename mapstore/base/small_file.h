// Reading a file that a person names on a command line and that must be small: a key, a token.
#pragma once

#include <cstddef>
#include <string>

#include "mapstore/base/status.h"

namespace maploc {

// No certificate chain, key or token comes near it; /dev/zero does.
inline constexpr std::size_t kMaxSmallFileBytes = 1 << 20;

// The file's bytes. INVALID_ARGUMENT with `reason`, naming the file, where it cannot be read or has
// more than kMaxSmallFileBytes. Thread-safe.
Result<std::string> ReadSmallFile(const std::string& path, const char* reason);

}  // namespace maploc
