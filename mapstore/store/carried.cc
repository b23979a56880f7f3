#include "mapstore/store/carried.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace maploc {
namespace {

// Less rounds to nothing in all but the longest sessions, and the list would grow with every
// version.
constexpr double kLeastWeight = 0.005;

std::vector<SegmentLandmarks> AllLandmarks(std::span<const Segment> segments,
                                           const Similarity3& fresh_from_map) {
  std::vector<SegmentLandmarks> landmarks;
  landmarks.reserve(segments.size());
  for (const Segment& segment : segments) landmarks.push_back(LandmarksOf(segment, fresh_from_map));
  return landmarks;
}

using WeightOf =
    std::map<std::tuple<SegmentId, std::int64_t, SegmentId>, double>;  // to, source, from

// Weights that are too small go to the largest of the same older segment (between equals to the
// lowest heir), so that nothing is lost of it.
std::vector<Inheritance> WithoutSmall(const WeightOf& weights) {
  std::map<std::pair<std::int64_t, SegmentId>, std::vector<Inheritance>> heirs;
  for (const auto& [key, weight] : weights) {
    const auto& [to, source, from] = key;
    heirs[{source, from}].push_back({source, from, to, weight});
  }
  std::vector<Inheritance> kept;
  for (auto& [older, shares] : heirs) {
    const auto largest = std::max_element(
        shares.begin(), shares.end(),
        [](const Inheritance& a, const Inheritance& b) { return a.weight < b.weight; });
    for (auto share = shares.begin(); share != shares.end(); ++share) {
      if (share == largest || share->weight >= kLeastWeight) continue;
      largest->weight += std::exchange(share->weight, 0.0);
    }
    for (Inheritance& share : shares) {
      if (share.weight < kLeastWeight) continue;
      // A sum of rounded products can exceed 1 by a rounding error, which the table's CHECK would
      // refuse.
      share.weight = std::min(share.weight, 1.0);
      kept.push_back(share);
    }
  }
  std::sort(kept.begin(), kept.end(), [](const Inheritance& a, const Inheritance& b) {
    return std::tie(a.to, a.source, a.from) < std::tie(b.to, b.source, b.from);
  });
  return kept;
}

using SharesBySource = std::map<std::int64_t, std::vector<CarriedShare>>;

SharesBySource GroupBySource(std::span<const Inheritance> inheritance) {
  SharesBySource shares;
  for (const Inheritance& share : inheritance) {
    shares[share.source].push_back({share.from, share.to, share.weight});
  }
  return shares;
}

// What one session taught the older segments, as a row of `segment`. REQUIRES: not empty.
std::optional<TrueRow> CarrySession(SegmentId segment, std::vector<const TrueRow*> parts,
                                    const SharesBySource& shares) {
  const TrueRow& any = *parts.front();
  const auto found = shares.find(any.source);
  if (found == shares.end()) return std::nullopt;
  // Sums of floating-point numbers depend on their order. A fixed order keeps results
  // bit-identical.
  std::sort(parts.begin(), parts.end(),
            [](const TrueRow* a, const TrueRow* b) { return a->row.segment < b->row.segment; });
  std::vector<SegmentSessionRow> taught;
  for (const TrueRow* part : parts) taught.push_back(part->row);
  // A count is divided among all heirs by the largest remainder, so the rows of the other heirs are
  // computed as well.
  for (SegmentSessionRow& carried : CarryRows(taught, found->second)) {
    if (carried.segment != segment) continue;
    return TrueRow{std::move(carried), any.source, any.end_unix_ns, any.options};
  }
  return std::nullopt;
}

}  // namespace

Segment WithoutDescriptors(const Segment& segment) {
  Segment bare;
  bare.map = segment.map;
  bare.id = segment.id;
  bare.path_in_map = segment.path_in_map;
  bare.points.ids = segment.points.ids;
  bare.points.positions_in_map = segment.points.positions_in_map;
  bare.lines.ids = segment.lines.ids;
  bare.lines.segments_in_map = segment.lines.segments_in_map;
  return bare;
}

std::vector<Inheritance> InheritFrom(std::int64_t predecessor, const MapInfo& old_info,
                                     std::span<const Segment> old_segments,
                                     std::span<const Inheritance> older, const MapInfo& fresh_info,
                                     std::span<const Segment> fresh_segments) {
  // Ids differ between imports, so landmarks are recognized by their position in a common frame.
  const Similarity3 fresh_from_old =
      fresh_info.map_from_source * old_info.map_from_source.Inverse();
  const auto shares = CarryOver(AllLandmarks(old_segments, fresh_from_old),
                                AllLandmarks(fresh_segments, Similarity3{}),
                                SharedLandmarkTolerance(fresh_segments));
  WeightOf weights;
  for (const CarriedShare& share : shares) {
    weights[{share.to, predecessor, share.from}] += share.weight;
    // A share of a share: weights along a chain of versions multiply.
    for (const Inheritance& before : older) {
      if (before.to != share.from) continue;
      weights[{share.to, before.source, before.from}] += before.weight * share.weight;
    }
  }
  return WithoutSmall(weights);
}

std::vector<Inheritance> SharesBehind(SegmentId segment, std::span<const Inheritance> all) {
  std::set<std::pair<std::int64_t, SegmentId>> sources;
  for (const Inheritance& share : all) {
    if (share.to == segment) sources.emplace(share.source, share.from);
  }
  std::vector<Inheritance> shares;
  for (const Inheritance& share : all) {
    if (sources.contains({share.source, share.from})) shares.push_back(share);
  }
  return shares;
}

std::vector<TrueRow> WithInherited(SegmentId segment, std::vector<TrueRow> own,
                                   std::span<const TrueRow> rows,
                                   std::span<const Inheritance> inheritance) {
  std::map<SessionId, std::vector<const TrueRow*>> sessions;
  for (const TrueRow& row : rows) sessions[row.row.session].push_back(&row);
  const SharesBySource shares = GroupBySource(inheritance);
  for (const auto& [id, parts] : sessions) {
    if (auto carried = CarrySession(segment, parts, shares)) own.push_back(std::move(*carried));
  }
  std::sort(own.begin(), own.end(),
            [](const TrueRow& a, const TrueRow& b) { return a.position() < b.position(); });
  return own;
}

}  // namespace maploc
