// Snapshots of maps that are wholly in memory.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "server/pipeline/map_snapshot.h"
#include "tests/support/segment_places.h"

namespace maploc::testing {

class ResidentSegments final : public SegmentSource {
 public:
  explicit ResidentSegments(std::vector<std::shared_ptr<const Segment>> segments)
      : segments_(std::move(segments)) {}
  Result<std::shared_ptr<const Segment>> Get(SegmentId id, const Interrupt&) const override {
    return segments_[static_cast<std::size_t>(id)];
  }

 private:
  const std::vector<std::shared_ptr<const Segment>> segments_;
};

// REQUIRES: no null.
inline Result<std::shared_ptr<const MapSnapshot>> ResidentMap(
    const MapInfo& info, const std::vector<MapSnapshot::Entry>& entries) {
  std::vector<StrategyDecision> decisions;
  std::vector<std::shared_ptr<const Segment>> segments;
  for (const MapSnapshot::Entry& entry : entries) {
    decisions.push_back(entry.decision);
    segments.push_back(entry.segment);
  }
  const std::vector<SegmentPlace> places = PlacesOf(segments);
  return BuildMapSnapshot(info, std::move(decisions), places,
                          std::make_shared<const ResidentSegments>(std::move(segments)));
}

}  // namespace maploc::testing
