// One map version in memory, as queries see it.
#pragma once

#include <memory>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/model/map.h"
#include "mapstore/model/session.h"
#include "server/retrieval/place_index.h"

namespace maploc {

// Segments, the strategies in force, and what retrieval needs, built once a load. Immutable once
// shared; replaced as a whole when the store changes. When the strategies alone have changed, copy
// the old snapshot and replace the decisions: segments and index are shared, so the copy is cheap.
struct MapSnapshot {
  struct Entry {
    std::shared_ptr<const Segment> segment;
    StrategyDecision decision;
  };
  MapInfo info;
  std::vector<Entry> segments;  // by segment id: segments[i].segment->id == i
  std::shared_ptr<const PlaceIndex> places;
};

// Builds the index over `entries`. INTERNAL when an entry is null, or their ids do not count from 0
// without gaps.
Result<std::shared_ptr<const MapSnapshot>> BuildMapSnapshot(
    const MapInfo& info, std::vector<MapSnapshot::Entry> entries);

}  // namespace maploc
