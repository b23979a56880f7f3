// Joins several segments to one, for queries that find too few matches in each segment alone.
#pragma once

#include <memory>
#include <vector>

#include "mapstore/model/localization.h"
#include "mapstore/model/map.h"

namespace maploc {

// All landmarks of the segments, each once, with the descriptors and the position of the first
// segment that holds it. Their viewing ranges are kept if all segments know them. Id, map and path
// are the first segment's. REQUIRES: at least one segment, all of one map. O(their size).
Segment JoinSegments(const std::vector<std::shared_ptr<const Segment>>& segments);

// Changes an answer about the joint segment to one about the part that holds most of its inliers
// (the first of equals). Segment, matches, flags and counts then cover that part's landmarks alone;
// pose, confidence and all else stay. REQUIRES: the answer's matches name landmarks of `joint`,
// which was joined from `parts`.
void TellOfOnePart(const Segment& joint, const std::vector<std::shared_ptr<const Segment>>& parts,
                   Localization& answer);

}  // namespace maploc
