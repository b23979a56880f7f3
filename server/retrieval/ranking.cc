#include "server/retrieval/ranking.h"

#include <algorithm>
#include <numeric>

#include "mapstore/descriptors/knn.h"
#include "server/retrieval/path_distance.h"

namespace maploc {
namespace {

using Segments = std::span<const std::shared_ptr<const Segment>>;

// Every k-th row: features are often sorted by strength or by place, and a stride keeps the
// mixture.
Descriptors EvenSample(const Descriptors& all, int max_rows) {
  if (all.size() <= max_rows) return all;
  Descriptors sample{all.kind, {}};
  for (int i = 0; i < max_rows; ++i) {
    const auto row =
        all.row(static_cast<int>(static_cast<std::int64_t>(i) * all.size() / max_rows));
    sample.bytes.insert(sample.bytes.end(), row.begin(), row.end());
  }
  return sample;
}

struct Candidate {
  int segment = 0;
  double distance = 0.0;  // from the prior to the path, in the prior's sigmas
};

std::vector<Candidate> NearPrior(const PosePrior& prior, Segments segments,
                                 const PlaceIndex& places, double max_sigmas) {
  std::vector<Candidate> near;
  for (int s = 0; s < static_cast<int>(segments.size()); ++s) {
    const std::vector<Eigen::Vector3d>& path = segments[s]->path_in_map;
    const double distance = path.empty() ? 0.0 : DistanceToPath(prior.position_in_map, path);
    if (distance > max_sigmas * prior.sigma_m + places.ReachOf(s)) continue;
    near.push_back({s, distance / prior.sigma_m});
  }
  return near;
}

// The first `count` of `segments` in the order of `better`, ties by id.
template <class Better>
std::vector<int> Best(std::vector<int> segments, int count, const Better& better) {
  std::stable_sort(segments.begin(), segments.end(), better);
  if (static_cast<int>(segments.size()) > count) segments.resize(count);
  return segments;
}

std::vector<int> BestByDistance(std::vector<Candidate> near) {
  std::stable_sort(near.begin(), near.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  std::vector<int> ranked;
  for (const Candidate& candidate : near) ranked.push_back(candidate.segment);
  return ranked;
}

}  // namespace

std::vector<int> CountVotes(const PointFeatures& features, const PlaceIndex& places,
                            int segment_count, const RetrievalOptions& options) {
  std::vector<int> votes(segment_count, 0);
  const Descriptors sample = EvenSample(features.descriptors, options.max_features);
  if (sample.size() == 0 || places.landmark_count() == 0) return votes;
  const MatchOptions match{.max_ratio = options.max_ratio, .mutual = false};
  for (const FeatureMatch& m :
       MatchDescriptors(sample, places.descriptors(), places.row_landmark(), match)) {
    for (const std::int32_t segment : places.SegmentsOf(m.landmark)) ++votes[segment];
  }
  return votes;
}

std::vector<int> RankSegments(const PointFeatures& features, const std::optional<PosePrior>& prior,
                              Segments segments, const PlaceIndex& places,
                              const RetrievalOptions& options) {
  std::vector<int> candidates(segments.size());
  std::iota(candidates.begin(), candidates.end(), 0);
  if (prior) {
    const std::vector<Candidate> near = NearPrior(*prior, segments, places, options.max_sigmas);
    if (static_cast<int>(near.size()) <= options.max_segments) return BestByDistance(near);
    candidates.clear();
    for (const Candidate& candidate : near) candidates.push_back(candidate.segment);
  }
  if (candidates.size() <= 1) return candidates;
  const std::vector<int> votes =
      CountVotes(features, places, static_cast<int>(segments.size()), options);
  return Best(std::move(candidates), options.max_segments,
              [&](int a, int b) { return votes[a] > votes[b]; });
}

}  // namespace maploc
