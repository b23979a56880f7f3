#include "mapstore/store/in_memory_data.h"

#include <algorithm>

namespace maploc {
namespace {

std::vector<Segment> PlacesOf(const InMemoryMap& map) {
  std::vector<Segment> places;
  for (const InMemorySegment& stored : map.segments) {
    places.push_back(WithoutDescriptors(*stored.segment));
  }
  return places;
}

}  // namespace

void AddObservations(InMemorySession& session, std::span<const Observation> observations) {
  for (const Observation& added : observations) {
    const auto is_same_query = [&added](const auto& entry) {
      return entry.second.counted_as == added.counted_as;
    };
    const bool is_known =
        !added.counted_as.empty() && std::ranges::any_of(session.observations, is_same_query);
    if (!is_known) session.observations.try_emplace(added.sequence, added);
  }
}

std::vector<Observation> InOrder(const std::map<std::int64_t, Observation>& observations) {
  std::vector<Observation> ordered;
  for (const auto& [sequence, observation] : observations) {
    ordered.push_back(observation);
    // No store keeps it (map_store.h). The store on disk has no column for it.
    ordered.back().evidence.focal_scale.reset();
  }
  return ordered;
}

SegmentSummary Summarize(const InMemorySegment& stored) {
  const Segment& segment = *stored.segment;
  SegmentSummary summary;
  summary.id = segment.id;
  summary.points = segment.points.size();
  summary.lines = segment.lines.size();
  summary.usable_lines = CountUsableLines(segment.lines);
  summary.path_in_map = segment.path_in_map;
  summary.statistics = stored.state.derived.statistics;
  summary.decision = stored.state.derived.decision;
  summary.pinned = stored.state.pinned;
  summary.selector = stored.state.options;
  return summary;
}

std::vector<Inheritance> InheritanceOf(const InMemoryMap& map, const InMemoryMap& predecessor) {
  const MapInfo& old_info = predecessor.summary.info;
  // Sources are named by their version here. The store on disk names them by their row.
  return InheritFrom(old_info.key.version, old_info, PlacesOf(predecessor), predecessor.inheritance,
                     map.summary.info, PlacesOf(map));
}

}  // namespace maploc
