// One map version, as queries see it.
#pragma once

#include <memory>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/model/map.h"
#include "mapstore/model/session.h"
#include "server/pipeline/segment_source.h"
#include "server/retrieval/place_index.h"

namespace maploc {

// The strategies in force, what retrieval needs, and where the segments come from. Immutable once
// shared; replaced as a whole when the store changes. When the strategies alone have changed, copy
// the old snapshot and replace the decisions: the rest is shared, so the copy is cheap.
struct MapSnapshot {
  // A segment, in use, and its strategy.
  struct Entry {
    std::shared_ptr<const Segment> segment;
    StrategyDecision decision;
  };
  // Loads the segment where it is not in memory; the source's errors. REQUIRES: a segment of the
  // map.
  Result<Entry> Load(SegmentId id, const Interrupt& interrupt) const;

  MapInfo info;
  std::vector<StrategyDecision> decisions;  // by segment id
  std::shared_ptr<const PlaceIndex> places;
  std::shared_ptr<const SegmentSource> segments;
};

// Builds the index over `places`. INTERNAL when their ids do not count from 0 without gaps, or
// there are not as many as decisions.
Result<std::shared_ptr<const MapSnapshot>> BuildMapSnapshot(
    const MapInfo& info, std::vector<StrategyDecision> decisions,
    const std::vector<SegmentPlace>& places, std::shared_ptr<const SegmentSource> segments);

}  // namespace maploc
