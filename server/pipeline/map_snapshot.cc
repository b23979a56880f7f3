#include "server/pipeline/map_snapshot.h"

#include <string>
#include <utility>

namespace maploc {
namespace {

Status CheckPlaces(const MapInfo& info, std::size_t decisions,
                   const std::vector<SegmentPlace>& places) {
  bool in_place = places.size() == decisions;
  for (std::size_t i = 0; i < places.size(); ++i) {
    in_place = in_place && places[i].id == static_cast<SegmentId>(i);
  }
  if (in_place) return Status::Ok();
  return Internal("map '" + info.key.name + "': a segment is missing or out of its place");
}

}  // namespace

Result<MapSnapshot::Entry> MapSnapshot::Load(SegmentId id, const Interrupt& interrupt) const {
  MAPLOC_ASSIGN_OR_RETURN(std::shared_ptr<const Segment> segment, segments->Get(id, interrupt));
  return Entry{std::move(segment), decisions[static_cast<std::size_t>(id)]};
}

Result<std::shared_ptr<const MapSnapshot>> BuildMapSnapshot(
    const MapInfo& info, std::vector<StrategyDecision> decisions,
    const std::vector<SegmentPlace>& places, std::shared_ptr<const SegmentSource> segments) {
  MAPLOC_RETURN_IF_ERROR(CheckPlaces(info, decisions.size(), places));
  auto snapshot = std::make_shared<MapSnapshot>();
  snapshot->info = info;
  snapshot->decisions = std::move(decisions);
  snapshot->places = std::make_shared<const PlaceIndex>(PlaceIndex::Build(places));
  snapshot->segments = std::move(segments);
  return std::shared_ptr<const MapSnapshot>(std::move(snapshot));
}

}  // namespace maploc
