// What `explain` and `plot` tell, each from one state of a store that others may write to
// meanwhile: UNAVAILABLE (STORE_MOVES) when it never stood still.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mapstore/statistics/explain.h"
#include "mapstore/store/map_store.h"
#include "mapstore/tools/decline.h"

namespace maploc {

struct ExplainedSegment {
  MapKey map;
  SegmentId segment = 0;
  Explanation explanation;
  std::vector<DecisionRecord> history;  // oldest first
};
// Of the map's enabled version.
Result<ExplainedSegment> ReadExplained(const MapStore& store, const std::string& map,
                                       SegmentId segment);

struct ChangedMap {
  MapKey map;
  std::vector<SegmentSummary> segments;
  std::vector<SegmentChanges> changes;  // one a segment
};
// Of the map's version, the enabled one where none is given.
Result<ChangedMap> ReadChanged(const MapStore& store, const std::string& map,
                               std::optional<std::int64_t> version);

}  // namespace maploc
