// Segments that a LOCALIZED answer may be confused with, as equal rooms are.
#pragma once

#include <vector>

#include "mapstore/model/localization.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/tried_segments.h"
#include "server/retrieval/ranking.h"

namespace maploc {

// Segments with two fifths of the clear matches that the answer's segment has, counting matches
// that speak for another place alone: with landmarks that the answer's segment does not hold, and
// far from the feature under the answer's pose (a place that was mapped twice is near it). At most
// two, most matches first; none where the prior alone ranked. Loads the segments that could be one.
// Errors as TriedSegments::Load. REQUIRES: `answer` has a pose. Deterministic.
Result<std::vector<int>> FindTwins(const QueryContext& context, const Ranking& ranking,
                                   const Localization& answer, TriedSegments& segments,
                                   StageTimes& times);

}  // namespace maploc
