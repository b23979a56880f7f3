// What a path names, as far as this process may see: false where it may not, or where the name is
// too long for a file. (std::filesystem's own throw then.) Links are followed. Thread-safe.
#pragma once

#include <string>

namespace maploc {

bool Exists(const std::string& path);
bool IsRegularFile(const std::string& path);
bool IsFolder(const std::string& path);

}  // namespace maploc
