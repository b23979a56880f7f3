// A store's messages for whoever must not know where the store lies.
#pragma once

#include <string>

namespace maploc {

// `message` with "STORE" in the path's place, and without the path where it stands in front ("PATH:
// what failed"). A path without a folder ("map") says nothing of a place and may be a word of the
// message: it stays.
std::string WithoutPath(const std::string& message, const std::string& path);

}  // namespace maploc
