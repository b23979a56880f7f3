// Files of 3D lines that other programs write, known by their content. Only for this folder.
#pragma once

#include <string>
#include <string_view>

namespace maploc {

// "LIMAP's line tracks (alltracks.txt)" and the like; "" for what looks like none of them. `path`
// may be a folder, whose `bytes` are then none.
std::string NameForeignLines(const std::string& path, std::string_view bytes);

}  // namespace maploc
