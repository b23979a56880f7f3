// A facade of equal windows, seen head-on from 8 m, without one true match: each match takes a spot
// of its window for the same spot of another window.
#pragma once

#include "mapstore/base/random.h"
#include "mapstore/model/matches.h"

namespace maploc::testing {

struct RepeatedPatternOptions {
  int matches = 100;
  double line_share = 0.0;     // of the matches: window edges
  double shifted_share = 0.0;  // of the matches, all off by the SAME windows: a wrong pose explains
                               // these; the others are off each by its own
};

PoseProblem MakeRepeatedPattern(const RepeatedPatternOptions& options, Random& random);

}  // namespace maploc::testing
