// The store's summaries as messages.
#pragma once

#include "maploc/v1/map_service.pb.h"
#include "mapstore/base/status.h"
#include "mapstore/store/map_store.h"

namespace maploc {

void MapSummaryToProto(const MapSummary& summary, v1::Map* proto);
// The path stands in GetSegment's answer alone.
void SegmentSummaryToProto(const SegmentSummary& summary, bool with_path, v1::Segment* proto);
// The newest version of a map that a request names. INVALID_ARGUMENT (the field `map`), NOT_FOUND
// (MAP_NOT_FOUND), or the store's errors.
Result<MapSummary> FindMap(const MapStore& store, const std::string& name);

}  // namespace maploc
