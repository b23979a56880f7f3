// A map's landmarks from one version to a new one, in the same store or in another.
#pragma once

#include <functional>

#include "mapstore/base/status.h"
#include "mapstore/store/map_store.h"

namespace maploc {

// What becomes of each segment on the way.
using SegmentChanger = std::function<Segment(const Segment&)>;

// The segments of `version` in `from`, as a new version of `info`'s name in `to`, with `info`'s
// other fields. An import like any other: it inherits what the sessions
// of an older version in `to` taught, and a failure leaves no half map.
Result<MapKey> CopyMap(const MapStore& from, const MapKey& version, MapStore& to,
                       const MapInfo& info, const Publishing& publishing,
                       const SegmentChanger& change);

}  // namespace maploc
