#include "tests/experiments/selection/selection_set.h"

#include "mapstore/store/in_memory_store.h"
#include "tests/support/resident_map.h"

namespace maploc::selection {

Result<std::shared_ptr<const MapSnapshot>> ImportMap(const ColmapImportOptions& options) {
  const std::unique_ptr<MapStore> store = NewInMemoryStore();
  MAPLOC_ASSIGN_OR_RETURN(
      const ColmapImportReport report,
      ImportColmap(options, [&]() -> Result<MapStore*> { return store.get(); }));
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<SegmentSummary> summaries,
                          store->ListSegments(report.info.key));
  std::vector<MapSnapshot::Entry> entries;
  for (const SegmentSummary& summary : summaries) {
    MAPLOC_ASSIGN_OR_RETURN(std::shared_ptr<const Segment> segment,
                            store->LoadSegment(report.info.key, summary.id));
    entries.push_back({std::move(segment), summary.decision});
  }
  return testing::ResidentMap(report.info, entries);
}

}  // namespace maploc::selection
