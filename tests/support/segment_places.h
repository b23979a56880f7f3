// The places of segments that are in memory.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "mapstore/descriptors/segment_place.h"

namespace maploc::testing {

inline std::vector<SegmentPlace> PlacesOf(
    std::span<const std::shared_ptr<const Segment>> segments) {
  std::vector<SegmentPlace> places;
  for (const auto& segment : segments) places.push_back(PlaceOf(*segment));
  return places;
}

}  // namespace maploc::testing
