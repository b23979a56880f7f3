#include "mapstore/tools/readings.h"

#include <utility>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/unmoved.h"

namespace maploc {
namespace {

// In several transactions, between which a session may end or a version be published.
Result<ExplainedSegment> ExplainOnce(const MapStore& store, const std::string& name, SegmentId id) {
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, store.GetMap(name));
  const MapKey& key = map.info.key;
  MAPLOC_ASSIGN_OR_RETURN(const SegmentSummary segment, store.GetSegment(key, id));
  MAPLOC_ASSIGN_OR_RETURN(const auto rows, store.ListRows(key, id));
  MAPLOC_ASSIGN_OR_RETURN(auto history, store.ListDecisions(key, id));
  return ExplainedSegment{key, id, ExplainStrategy(rows, segment.decision, segment.selector),
                          std::move(history)};
}

Result<ChangedMap> FindChangesOnce(const MapStore& store, const std::string& name,
                                   std::optional<std::int64_t> version) {
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, FindMap(store, name, version));
  ChangedMap changed{map.info.key, {}, {}};
  MAPLOC_ASSIGN_OR_RETURN(changed.segments, store.ListSegments(changed.map));
  for (const SegmentSummary& segment : changed.segments) {
    MAPLOC_ASSIGN_OR_RETURN(const auto rows, store.ListRows(changed.map, segment.id));
    changed.changes.push_back({segment.id, FindChanges(rows, segment.selector.statistics)});
  }
  return changed;
}

}  // namespace

Result<ExplainedSegment> ReadExplained(const MapStore& store, const std::string& map,
                                       SegmentId segment) {
  return ReadUnmoved(store, [&] { return ExplainOnce(store, map, segment); });
}

Result<ChangedMap> ReadChanged(const MapStore& store, const std::string& map,
                               std::optional<std::int64_t> version) {
  return ReadUnmoved(store, [&] { return FindChangesOnce(store, map, version); });
}

}  // namespace maploc
