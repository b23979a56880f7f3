// Which segments could this query be in? Best first. Deterministic; thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "mapstore/descriptors/knn.h"
#include "mapstore/model/map.h"
#include "mapstore/model/query.h"
#include "server/retrieval/place_index.h"

namespace maploc {

struct RetrievalOptions {
  int max_segments = 3;    // the answer's length at most
  int max_shortlist = 16;  // segments that are matched one by one
  float max_ratio = 0.9f;  // of a match: nearest to second nearest landmark
};

// What a query's features match in the segments that it was compared with.
struct Ranking {
  // Indices into the segments that the index was built from, best first.
  std::vector<int> segments;
  // Of each segment that was matched: those of an even sample of the features. `landmark` is one
  // of the index.
  std::map<int, std::vector<FeatureMatch>> matches;
};

// Indices into the segments that `places` was built from, best first, at most max_segments.
// * A prior leaves out the segments whose path is farther from it than 4 sigmas plus their reach;
//   where none is left it is empty (OUT_OF_MAP). A segment without a path is never left
//   out. No more than max_segments left: nearest first, and nothing is matched.
// * More than max_shortlist candidates: those with most votes stay (CountVotes).
// * The rest is matched with each segment and ranked by SegmentScore; ties by id.
// REQUIRES: the features' kind is the map's.
Ranking RankSegments(const PointFeatures& features, const std::optional<PosePrior>& prior,
                     const PlaceIndex& places, const RetrievalOptions& options = {});

// One search over the whole map: a feature whose nearest landmark passes the ratio test votes for
// each segment that holds it.
std::vector<int> CountVotes(const Descriptors& features, const PlaceIndex& places,
                            int segment_count, float max_ratio);

// The mutual ratio matches of the features with the segment's landmarks in `places`; `landmark` is
// one of the index. `segment` is an index into the segments that `places` was built from.
std::vector<FeatureMatch> MatchPlace(const Descriptors& features, const PlaceIndex& places,
                                     int segment, float max_ratio);

// Sum of (1 - ratio): a clear match counts more than one that barely passes, and those are mostly
// false.
double SegmentScore(std::span<const FeatureMatch> matches);

}  // namespace maploc
