// Was the photo mirrored before its features were extracted?
#pragma once

#include "mapstore/model/map.h"
#include "mapstore/model/query.h"

namespace maploc {

// Whether the descriptors, turned over, match the segment clearly better than as they were sent. A
// mirrored photo of a mirror-symmetric front (each tower taken for the other) agrees with a pose
// as an honest one does; its descriptors do not. Looks at 1000 points, spread over all, and where
// these leave it open at all; false for kinds that cannot be turned over (all but SIFT).
// Deterministic; thread-safe.
bool MatchesBetterMirrored(const View& view, const Segment& segment);

}  // namespace maploc
