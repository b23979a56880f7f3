// Matches of a view's points and lines with a segment's landmarks.
#pragma once

#include <vector>

#include "mapstore/descriptors/knn.h"
#include "mapstore/descriptors/neighbours.h"
#include "mapstore/model/map.h"
#include "mapstore/model/matches.h"
#include "mapstore/model/query.h"

namespace maploc {

// A match of this descriptor kind must have a ratio below this one. Measured (MEASUREMENTS.md).
float MaxRatio(const DescriptorKind& kind);

// Points and lines, each by nearest neighbour, ratio and mutual test. Lines that the segment does
// not describe in the view's kind give none. REQUIRES: the points' kinds are equal (or one side is
// empty). Deterministic; thread-safe.
Matches MatchSegment(const View& view, const Segment& segment);

// What a view's search in one segment found.
struct SegmentSearch {
  Matches matches;                 // MatchSegment's
  std::vector<Neighbours> points;  // one a point of the view; empty: nothing was searched
  std::vector<Neighbours> lines;   // one a line, alike
};
SegmentSearch SearchSegment(const View& view, const Segment& segment);

// Those of MatchSegment's matches that an even sample of `point_count` points has, and all lines':
// for a share of its time.
Matches MatchSample(const View& view, const Segment& segment, int point_count);

}  // namespace maploc
