// What the photos alone say about gravity: levels, verticals and brightness together.
#pragma once

#include <string>

#include "mapstore/importers/direction_fit.h"
#include "mapstore/importers/source_gravity.h"

namespace maploc {

struct PhotoGravity {
  DirectionFit fit;
  std::string basis;        // "the levels of 25 photos and 1774 vertical edges in 25 of them"
  std::string doubt;        // empty: sign and tilt are determined; else the reason why not
  bool has_axis = false;    // the tilt is determined, and in doubt is only which end is down
  bool is_witness = false;  // knows enough to speak against a direction from elsewhere
};

PhotoGravity EstimateFromPhotos(const GravityEvidence& evidence);

}  // namespace maploc
