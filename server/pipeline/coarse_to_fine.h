// A segment's answer from a sample of the query's points, made precise with the others.
#pragma once

#include <optional>

#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"
#include "server/pipeline/attempt.h"

namespace maploc {

// Finds and judges a pose by the matches of a sample of the points (and all lines). Then matches
// the other points near where that pose projects the landmarks, refines with all, and judges again.
// The answer's matches are all of these. Its evidence estimates what the full search would have
// counted: the sample's points, as many times as the sample goes into all points. (An estimate that
// is up to 2% too high, because a sample with fewer inliers goes the full way.) Those that were
// looked for near the pose are no evidence for it.
//
// None where the full search must decide, as if this had not been tried: few points, a threshold
// much wider than usual, or a pose that is not LOCALIZED twice with gravity as sent, or does not
// surely explain three quarters of the sample. `iterations` of the query count on. If the query is
// interrupted after the sample's pose was LOCALIZED so, that is the answer.
Result<std::optional<Localization>> TryCoarseToFine(const QueryContext& context,
                                                    const MapSnapshot::Entry& entry,
                                                    int& iterations, StageTimes& times);

}  // namespace maploc
