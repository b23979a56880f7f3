// The simulated campus as a set: a mapping drive in summer, imported as any map is, and one session
// a day of campus_days.h.
#pragma once

#include <cstdint>

#include "tests/experiments/selection/selection_set.h"

namespace maploc::selection {

struct CampusSetOptions {
  int queries = 240;  // a session, evenly around the lane
  std::uint64_t seed = 1;
};

// The same options give the same set. Writes the mapping drive below the system's folder of
// temporary files, and removes it. Errors: of that folder.
Result<SelectionSet> MakeCampusSet(const CampusSetOptions& options);

}  // namespace maploc::selection
