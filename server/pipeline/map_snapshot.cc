#include "server/pipeline/map_snapshot.h"

#include <string>
#include <utility>

namespace maploc {

Result<std::shared_ptr<const MapSnapshot>> BuildMapSnapshot(
    const MapInfo& info, std::vector<MapSnapshot::Entry> entries) {
  std::vector<SegmentPlace> places;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::shared_ptr<const Segment>& segment = entries[i].segment;
    if (segment == nullptr || segment->id != static_cast<SegmentId>(i)) {
      return Internal("map '" + info.key.name + "': segment " + std::to_string(i) +
                      " is missing or out of its place");
    }
    places.push_back(PlaceOf(*segment));
  }
  auto snapshot = std::make_shared<MapSnapshot>();
  snapshot->info = info;
  snapshot->segments = std::move(entries);
  snapshot->places = std::make_shared<const PlaceIndex>(PlaceIndex::Build(places));
  return std::shared_ptr<const MapSnapshot>(std::move(snapshot));
}

}  // namespace maploc
