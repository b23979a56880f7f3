// Which segments could this query be in? Best first. Deterministic; thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mapstore/model/map.h"
#include "mapstore/model/query.h"
#include "server/retrieval/place_index.h"

namespace maploc {

struct RetrievalOptions {
  int max_segments = 3;     // the answer's length at most
  int max_features = 500;   // of the query that vote, evenly spread over its order
  float max_ratio = 0.8f;   // of a vote: nearest to second nearest landmark of the whole map
  double max_sigmas = 4.0;  // farther from the prior (plus the segment's reach) is left out
};

// Indices into `segments`, best first, at most max_segments.
// * With a prior: the segments whose path lies within max_sigmas of it, plus their reach; nearest
//   first where they are few enough to be tried all, else ranked by votes among them. Empty when
//   there is none (OUT_OF_MAP). A segment without a path is never left out.
// * Without: all segments that get a vote, by votes; ties, and segments without votes, by id.
// A vote is a query feature whose nearest landmark of the whole map passes the ratio test; it
// counts for each segment that holds the landmark. REQUIRES: `places` was built from `segments`;
// the features' kind is the map's.
std::vector<int> RankSegments(const PointFeatures& features, const std::optional<PosePrior>& prior,
                              std::span<const std::shared_ptr<const Segment>> segments,
                              const PlaceIndex& places, const RetrievalOptions& options = {});

// Votes for each segment, as above.
std::vector<int> CountVotes(const PointFeatures& features, const PlaceIndex& places,
                            int segment_count, const RetrievalOptions& options = {});

}  // namespace maploc
