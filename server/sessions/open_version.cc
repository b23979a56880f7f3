#include "server/sessions/open_version.h"

#include <utility>
#include <vector>

namespace maploc {
namespace {

Result<std::vector<StrategyDecision>> LoadDecisions(const MapStore& store, const MapKey& key) {
  MAPLOC_ASSIGN_OR_RETURN(std::vector<SegmentSummary> segments, store.ListSegments(key));
  std::vector<StrategyDecision> decisions;
  for (SegmentSummary& summary : segments) decisions.push_back(std::move(summary.decision));
  return decisions;
}

}  // namespace

Result<std::shared_ptr<const MapSnapshot>> OpenVersion(const MapStore& store, const MapInfo& info,
                                                       SegmentCache& segments) {
  MAPLOC_ASSIGN_OR_RETURN(std::vector<StrategyDecision> decisions, LoadDecisions(store, info.key));
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<SegmentPlace> places, store.LoadPlaces(info.key));
  return BuildMapSnapshot(info, std::move(decisions), places, segments.Open(info));
}

}  // namespace maploc
