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

struct RepeatedCorridorOptions {
  int doors = 8;  // a wall, 2 to 4 m apart
  int spots = 6;  // a door
  int walls = 2;  // 1 or 2
  double gravity_sigma_rad = 0.017;
};

// Equal doors along a corridor, seen along it, without one true match: each spot of a door is taken
// for the same spot of another door, one to one. A step of the pattern moves what is near by more
// than what is far, so that wrong matches are not shifted alike in the image.
PoseProblem MakeRepeatedCorridor(const RepeatedCorridorOptions& options, Random& random);

}  // namespace maploc::testing
