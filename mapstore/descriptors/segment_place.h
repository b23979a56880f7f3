// What place recognition needs of a segment: a few descriptor rows of each point landmark, and from
// where the segment can be seen. It is a function of the segment, so small that those of a whole
// map stay in memory, and kept beside the segment, so that a map opens without reading landmarks.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mapstore/base/ids.h"
#include "mapstore/base/status.h"
#include "mapstore/model/descriptor.h"
#include "mapstore/model/map.h"

namespace maploc {

struct SegmentPlace {
  SegmentId id = 0;
  std::vector<Eigen::Vector3d> path_in_map;  // the segment's
  // How far off its path the segment can be seen from: the median distance from its points to its
  // path (map unit); 0 without points or path.
  double reach = 0.0;
  std::vector<LandmarkId> ids;                    // of the points; ascending, unique
  std::vector<std::int32_t> row_counts;           // one a landmark: its rows in the segment
  Descriptors descriptors;                        // RepresentativeRows of each landmark
  std::vector<std::int32_t> descriptor_landmark;  // one a row above: index into ids; ascending
};

// REQUIRES: a valid segment. O(its rows). Deterministic.
SegmentPlace PlaceOf(const Segment& segment);

// Every invariant above (but what only the segment could tell); names the field that breaks one.
// `kind` is the map's.
Status ValidatePlace(const DescriptorKind& kind, const SegmentPlace& place);

}  // namespace maploc
