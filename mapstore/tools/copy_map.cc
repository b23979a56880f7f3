#include "mapstore/tools/copy_map.h"

#include <memory>
#include <vector>

namespace maploc {

Result<MapKey> CopyMap(const MapStore& from, const MapKey& version, MapStore& to,
                       const MapInfo& info, const Publishing& publishing,
                       const SegmentChanger& change) {
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<SegmentSummary> segments, from.ListSegments(version));
  MAPLOC_ASSIGN_OR_RETURN(const std::unique_ptr<MapWriter> writer, to.BeginImport(info));
  // One after the other, so that memory holds one segment, however large the map.
  for (const SegmentSummary& summary : segments) {
    MAPLOC_ASSIGN_OR_RETURN(const auto segment, from.LoadSegment(version, summary.id));
    MAPLOC_RETURN_IF_ERROR(writer->AddSegment(change(*segment)));
  }
  MAPLOC_RETURN_IF_ERROR(writer->Commit(publishing));
  return writer->key();
}

}  // namespace maploc
