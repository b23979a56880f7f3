// Where the real data sets are; they are no part of the project.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace maploc::testing {

// MAPLOC_SHARED_DATA, else shared/data beside the repository. It may not be there.
inline std::filesystem::path SharedDataFolder() {
  const char* named = std::getenv("MAPLOC_SHARED_DATA");
  if (named != nullptr) return named;
  return (std::filesystem::path(MAPLOC_SOURCE_DIR) / ".." / "shared" / "data").lexically_normal();
}

}  // namespace maploc::testing
