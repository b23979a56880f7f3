// Whether a map leans, as its robots' gravity has it.
#pragma once

#include <string>
#include <vector>

#include "mapstore/tools/fleet.h"

namespace maploc {

// A line for each map version whose robots' gravity disagrees with it the same way: by how much,
// who says so, and the command that turns it. Revoked sessions do not count.
std::vector<std::string> DescribeLeans(const std::vector<SeenSession>& sessions);

}  // namespace maploc
