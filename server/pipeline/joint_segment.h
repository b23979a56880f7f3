// Several segments as one: what a place offers when its parts offer too little each.
#pragma once

#include <memory>
#include <vector>

#include "mapstore/model/localization.h"
#include "mapstore/model/map.h"

namespace maploc {

// All landmarks of the segments, each once, with the descriptors and the position that the first
// segment holding it has; from where they were seen is told where all segments know it. Id, map and
// path are the first segment's. REQUIRES: at least one segment,
// all of one map. O(their size).
Segment JoinSegments(const std::vector<std::shared_ptr<const Segment>>& segments);

// Makes an answer about the joint segment one about the part that holds most of its inliers (the
// first of equals): segment, matches, flags and counts are of that part's landmarks alone; pose,
// confidence and all else stay. REQUIRES: the answer's matches name landmarks of `joint`, which was
// joined from `parts`.
void TellOfOnePart(const Segment& joint, const std::vector<std::shared_ptr<const Segment>>& parts,
                   Localization& answer);

}  // namespace maploc
