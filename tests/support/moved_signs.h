// Signs that were moved after the map was made, or taken for others like them: the features of each
// match as a whole, at its old place. A pose that puts two or three of them there is wrong, however
// many features they have.
#pragma once

#include "mapstore/base/random.h"
#include "mapstore/model/matches.h"

namespace maploc::testing {

struct MovedSignsOptions {
  int signs = 2;
  int features = 8;         // a sign
  double radius_px = 12.0;  // of a sign in the image
  int others = 20;          // matches of random pixels with random landmarks
  double gravity_sigma_rad = 0.017;
};

// No match is true. A level camera sees signs of 10 cm radius head-on, at random pixels; in the map
// they hang elsewhere on one wall.
PoseProblem MakeMovedSigns(const MovedSignsOptions& options, Random& random);

}  // namespace maploc::testing
