// How a message tells what is missing: how many, the first few, of how many.
#pragma once

#include <string>
#include <vector>

namespace maploc {

// "12 of 180 images have no photo in photos: 'a', 'b', 'c', ...". `what` says what they lack.
// REQUIRES: names is not empty.
std::string MissingText(const std::vector<std::string>& names, std::size_t total,
                        const std::string& what);

// "2 of 180 photos are truncated: 'a', 'b'". `what` says what they are. REQUIRES: as above.
std::string ListText(const std::vector<std::string>& names, std::size_t total,
                     const std::string& what);

}  // namespace maploc
