// Queries without one true match: 100 to 2,000 of them (but for signs), gravity's sigma 0.1 to 2
// degrees (facades: 0.5).
#pragma once

#include "mapstore/base/random.h"
#include "mapstore/model/matches.h"

namespace maploc::experiments {

inline constexpr double kLineShare = 0.3;  // of the matches, where there are lines

// In the cube or the corridor; random pixels or wrong associations; lines in any direction or 80%
// of them vertical.
PoseProblem MakeRandomMatches(double line_share, Random& random);

// A facade of equal windows; `shifted_share` of the matches are off by the same windows, the others
// each by its own (tests/support/repeated_pattern.h).
PoseProblem MakeFacade(double line_share, double shifted_share, Random& random);

// Two to four signs that were moved, 5 to 15 features each, among 10 to 60 other wrong matches:
// fewer than of the other kinds, since chance is guarded against where there are many.
PoseProblem MakeSigns(Random& random);

}  // namespace maploc::experiments
