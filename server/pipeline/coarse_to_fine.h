// A segment's answer from a sample of the query's points, made precise with the others.
#pragma once

#include <optional>

#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"
#include "server/pipeline/attempt.h"

namespace maploc {

// Finds and judges a pose by the matches of a sample of the points (and all lines). Then matches
// the other points near where that pose projects the landmarks, refines with all, and judges again.
// The matches of the answer are all of them, its evidence counts the sample's points alone, as the
// full search would have matched them: those that were looked for near the pose are no evidence for
// it.
//
// None where the full search must decide: few features, or a pose that was not LOCALIZED twice, or
// leaves a quarter of the sample unexplained. `iterations` and `times` as TryMatches.
Result<std::optional<Localization>> TryCoarseToFine(const QueryContext& context,
                                                    const MapSnapshot::Entry& entry,
                                                    int& iterations, StageTimes& times);

}  // namespace maploc
