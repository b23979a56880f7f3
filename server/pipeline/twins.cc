#include "server/pipeline/twins.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include "mapstore/geometry/pixel_scale.h"

namespace maploc {
namespace {

// Share of the answer's clear matches. The same share of inliers makes another pose a doubt
// (UnlessTwin).
constexpr double kTwinShare = 0.4;
constexpr float kClearRatio = 0.75f;
constexpr std::size_t kMostTwins = 2;
// In inlier thresholds. Wider than one, because a place that was mapped twice is not mapped alike;
// of another place's landmarks one in 240 lies as near by chance (20 pixels of a VGA-sized image).
constexpr double kNear = 5.0;

bool IsClear(const FeatureMatch& match) { return match.ratio < kClearRatio; }

// Where the answer's camera sees the landmarks of one segment.
class SeenFromAnswer {
 public:
  SeenFromAnswer(const QueryContext& context, const Localization& answer, const Segment& segment)
      : view_(context.view()),
        points_(segment.points),
        places_(*context.map.places),
        camera_from_map_(view_.camera_from_body * answer.map_from_body->Inverse()),
        radius_px_(kNear * context.MaxErrorVgaPx() * PixelScale(view_.camera)) {}

  // Whether the matched landmark is near the matched feature.
  bool Explains(const FeatureMatch& match) const {
    const LandmarkId id = places_.IdOf(match.landmark);
    const auto found = std::ranges::lower_bound(points_.ids, id);
    // The place index is kept beside the segment, and read apart from it.
    if (found == points_.ids.end() || *found != id) return false;
    const Eigen::Vector3d& point_in_map = points_.positions_in_map[found - points_.ids.begin()];
    const auto pixel = view_.camera.Project(camera_from_map_ * point_in_map);
    const Eigen::Vector2d feature_px = view_.points.keypoints_px[match.feature].cast<double>();
    return pixel && (*pixel - feature_px).norm() < radius_px_;
  }

 private:
  const View& view_;
  const PointLandmarks& points_;
  const PlaceIndex& places_;
  Rigid3 camera_from_map_;
  double radius_px_;
};

// The clear matches with landmarks that the segment `answered` does not hold.
std::vector<FeatureMatch> ClearForeign(const std::vector<FeatureMatch>& matches, int answered,
                                       const PlaceIndex& places) {
  std::vector<FeatureMatch> foreign;
  std::ranges::copy_if(matches, std::back_inserter(foreign), [&](const FeatureMatch& match) {
    return IsClear(match) &&
           !std::ranges::binary_search(places.SegmentsOf(match.landmark), answered);
  });
  return foreign;
}

bool IsTwin(std::ptrdiff_t matches, double needed) {
  return matches > 0 && static_cast<double>(matches) >= needed;
}

}  // namespace

Result<std::vector<int>> FindTwins(const QueryContext& context, const Ranking& ranking,
                                   const Localization& answer, TriedSegments& segments,
                                   StageTimes& times) {
  const auto own = ranking.matches.find(answer.segment);
  // A prior that leaves few segments ranks them by distance, and nothing was matched.
  if (own == ranking.matches.end()) return std::vector<int>();
  const double needed =
      kTwinShare * static_cast<double>(std::ranges::count_if(own->second, IsClear));
  std::vector<std::pair<std::ptrdiff_t, int>> twins;  // matches, negative, and segment
  for (const auto& [other, matches] : ranking.matches) {
    if (other == answer.segment) continue;
    std::vector<FeatureMatch> foreign = ClearForeign(matches, answer.segment, *context.map.places);
    if (!IsTwin(std::ssize(foreign), needed)) continue;
    MAPLOC_ASSIGN_OR_RETURN(const MapSnapshot::Entry* const entry, segments.Load(other, times));
    const SeenFromAnswer seen(context, answer, *entry->segment);
    std::erase_if(foreign, [&](const FeatureMatch& match) { return seen.Explains(match); });
    if (IsTwin(std::ssize(foreign), needed)) twins.emplace_back(-std::ssize(foreign), other);
  }
  std::sort(twins.begin(), twins.end());
  std::vector<int> best;
  for (const auto& twin : twins) best.push_back(twin.second);
  if (best.size() > kMostTwins) best.resize(kMostTwins);
  return best;
}

}  // namespace maploc
