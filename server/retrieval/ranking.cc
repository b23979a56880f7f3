#include "server/retrieval/ranking.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "mapstore/base/even_sample.h"
#include "mapstore/descriptors/knn.h"
#include "mapstore/geometry/path_distance.h"

namespace maploc {
namespace {

// Features of the query that are matched with the shortlist, evenly spread over its order: as many
// as kMaxPairs allows (features x rows of the place index), between these bounds. CountVotes
// gets kMinFeatures.
constexpr std::int64_t kMaxFeatures = 500;
constexpr int kMinFeatures = 100;
constexpr std::int64_t kMaxPairs = 2'000'000;
// A segment farther from the prior (plus the segment's reach) is left out.
constexpr double kMaxSigmas = 4.0;

Descriptors EvenRows(const Descriptors& all, int max_rows) {
  return GatherRows(all, EvenSample(all.size(), max_rows));
}

std::int64_t CountRows(const std::vector<int>& candidates, const PlaceIndex& places) {
  std::int64_t rows = 0;
  for (const int s : candidates) rows += std::ssize(places.RowsOf(s));
  return rows;
}

int FeatureBudget(std::int64_t rows) {
  const std::int64_t affordable = kMaxPairs / std::max<std::int64_t>(rows, 1);
  return static_cast<int>(std::clamp<std::int64_t>(affordable, kMinFeatures, kMaxFeatures));
}

struct Candidate {
  int segment = 0;
  double distance = 0.0;  // from the prior to the path, in the prior's sigmas
};

std::vector<Candidate> NearPrior(const PosePrior& prior, const PlaceIndex& places) {
  std::vector<Candidate> near;
  for (int s = 0; s < places.segment_count(); ++s) {
    const std::vector<Eigen::Vector3d>& path = places.PathOf(s);
    const double distance = path.empty() ? 0.0 : DistanceToPath(prior.position_in_map, path);
    if (distance > kMaxSigmas * prior.sigma_m + places.ReachOf(s)) continue;
    near.push_back({s, distance / prior.sigma_m});
  }
  return near;
}

// The first `count` of `candidates` by falling score (by segment), ties by id.
template <typename Score>
std::vector<int> Best(std::vector<int> candidates, int count, const std::vector<Score>& score) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](int a, int b) { return score[a] > score[b]; });
  if (static_cast<int>(candidates.size()) > count) candidates.resize(count);
  return candidates;
}

std::vector<int> BestByDistance(std::vector<Candidate> near) {
  std::stable_sort(near.begin(), near.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  std::vector<int> ranked;
  for (const Candidate& candidate : near) ranked.push_back(candidate.segment);
  return ranked;
}

// Matching one by one costs the segments' overlap more than one search over the map, but its
// ranking is better: landmarks that were mapped twice do not fail each other's ratio test.
Ranking RankByFeatures(const Descriptors& all_features, std::vector<int> candidates,
                       int segment_count, const PlaceIndex& places,
                       const RetrievalOptions& options) {
  if (static_cast<int>(candidates.size()) > options.max_shortlist) {
    const std::vector<int> votes =
        CountVotes(EvenRows(all_features, kMinFeatures), places, segment_count, options.max_ratio);
    candidates = Best(std::move(candidates), options.max_shortlist, votes);
    // Ascending again, because Best leaves equals in their order, and ties go by id.
    std::sort(candidates.begin(), candidates.end());
  }
  const std::vector<int> sample =
      EvenSample(all_features.size(), FeatureBudget(CountRows(candidates, places)));
  const Descriptors features = GatherRows(all_features, sample);
  std::vector<double> scores(segment_count, 0.0);
  Ranking ranking;
  for (const int s : candidates) {
    std::vector<FeatureMatch> matches = MatchPlace(features, places, s, options.max_ratio);
    scores[s] = SegmentScore(matches);
    for (FeatureMatch& match : matches) match.feature = sample[match.feature];
    ranking.matches[s] = std::move(matches);
  }
  ranking.segments = Best(std::move(candidates), options.max_segments, scores);
  return ranking;
}

}  // namespace

std::vector<int> CountVotes(const Descriptors& features, const PlaceIndex& places,
                            int segment_count, float max_ratio) {
  std::vector<int> votes(segment_count, 0);
  const MatchOptions options{.max_ratio = max_ratio, .mutual = false};
  for (const FeatureMatch& match :
       MatchDescriptors(features, places.descriptors(), places.row_landmark(), options)) {
    for (const std::int32_t segment : places.SegmentsOf(match.landmark)) ++votes[segment];
  }
  return votes;
}

std::vector<FeatureMatch> MatchPlace(const Descriptors& features, const PlaceIndex& places,
                                     int segment, float max_ratio) {
  const Descriptors rows = GatherRows(places.descriptors(), places.RowsOf(segment));
  std::vector<std::int32_t> owners;
  for (const std::int32_t row : places.RowsOf(segment)) {
    owners.push_back(places.row_landmark()[row]);
  }
  return MatchDescriptors(features, rows, owners, {.max_ratio = max_ratio});
}

double SegmentScore(std::span<const FeatureMatch> matches) {
  double score = 0.0;
  for (const FeatureMatch& match : matches) score += 1.0 - static_cast<double>(match.ratio);
  return score;
}

Ranking RankSegments(const PointFeatures& features, const std::optional<PosePrior>& prior,
                     const PlaceIndex& places, const RetrievalOptions& options) {
  std::vector<int> candidates(places.segment_count());
  std::iota(candidates.begin(), candidates.end(), 0);
  if (prior) {
    const std::vector<Candidate> near = NearPrior(*prior, places);
    if (static_cast<int>(near.size()) <= options.max_segments) return {BestByDistance(near), {}};
    candidates.clear();
    for (const Candidate& candidate : near) candidates.push_back(candidate.segment);
  }
  if (candidates.size() <= 1) return {std::move(candidates), {}};
  return RankByFeatures(features.descriptors, std::move(candidates), places.segment_count(), places,
                        options);
}

}  // namespace maploc
