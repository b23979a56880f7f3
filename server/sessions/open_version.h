// A map version as queries see it, from a store.
#pragma once

#include <memory>

#include "mapstore/base/status.h"
#include "mapstore/store/map_store.h"
#include "server/pipeline/map_snapshot.h"
#include "server/sessions/segment_cache.h"

namespace maploc {

// Reads no landmarks: `segments` does when a query needs them, and must outlive the snapshot.
Result<std::shared_ptr<const MapSnapshot>> OpenVersion(const MapStore& store, const MapInfo& info,
                                                       SegmentCache& segments);

}  // namespace maploc
