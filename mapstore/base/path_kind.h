// What a path names. False, too, where this process may not look, or where the name is too long for
// a file: the functions of std::filesystem throw in these cases. Links are followed. Thread-safe.
#pragma once

#include <string>

namespace maploc {

bool Exists(const std::string& path);
bool IsRegularFile(const std::string& path);
bool IsFolder(const std::string& path);

}  // namespace maploc
