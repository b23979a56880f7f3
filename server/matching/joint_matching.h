// A view's matches with several segments together, from its searches in each of them: nothing is
// searched again.
#pragma once

#include <vector>

#include "mapstore/model/map.h"
#include "mapstore/model/matches.h"
#include "server/matching/segment_matching.h"

namespace maploc {

// One of the segments, and what was found in it.
struct SearchedSegment {
  const Segment* segment;
  const SegmentSearch* search;
};

// What MatchSegment(view, joint) finds, where `joint` has the landmarks of all `parts`, each once:
// the nearest landmark of all is the nearest one of a part, and which feature is nearest to a
// landmark does not depend on the other landmarks. REQUIRES: the searches are of one view.
// Deterministic; thread-safe.
Matches MatchJointly(const std::vector<SearchedSegment>& parts, const Segment& joint);

}  // namespace maploc
