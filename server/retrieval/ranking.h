// Which segments could this query be in? Best first. Deterministic; thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mapstore/model/map.h"
#include "mapstore/model/query.h"
#include "server/retrieval/place_index.h"

namespace maploc {

struct RetrievalOptions {
  int max_segments = 3;    // the answer's length at most
  int max_shortlist = 16;  // segments that are matched one by one
  float max_ratio = 0.9f;  // of a match: nearest to second nearest landmark
};

// Indices into the segments that `places` was built from, best first, at most max_segments.
// * A prior leaves out the segments whose path is farther from it than 4 sigmas plus their reach;
//   where none is left the answer is empty (OUT_OF_MAP). A segment without a path is never left
//   out. No more than max_segments left: nearest first, and nothing is matched.
// * More than max_shortlist candidates: those with most votes stay (CountVotes).
// * The rest is matched with each segment and ranked by SegmentScore; ties by id.
// REQUIRES: the features' kind is the map's.
std::vector<int> RankSegments(const PointFeatures& features, const std::optional<PosePrior>& prior,
                              const PlaceIndex& places, const RetrievalOptions& options = {});

// One search over the whole map: a feature whose nearest landmark passes the ratio test votes for
// each segment that holds it.
std::vector<int> CountVotes(const Descriptors& features, const PlaceIndex& places,
                            int segment_count, float max_ratio);

// Sum of (1 - ratio) over the mutual ratio matches of the features with the segment's landmarks in
// `places`: a clear match counts more than one that barely passes, and those are mostly false.
// `segment` is an index into the segments that `places` was built from.
double SegmentScore(const Descriptors& features, const PlaceIndex& places, int segment,
                    float max_ratio);

}  // namespace maploc
