#include "server/matching/segment_matching.h"

#include <utility>

#include "mapstore/base/even_sample.h"

namespace maploc {
namespace {

struct KindSearch {
  std::vector<FeatureMatch> matches;
  std::vector<Neighbours> neighbours;
};

KindSearch SearchKind(const Descriptors& features, const Descriptors& landmarks,
                      const std::vector<std::int32_t>& row_landmark) {
  if (features.size() == 0 || landmarks.size() == 0) return {};
  KindSearch search;
  search.neighbours = FindNeighbours(features, landmarks, row_landmark);
  search.matches = MatchNeighbours(search.neighbours, features, landmarks, row_landmark,
                                   {.max_ratio = MaxRatio(landmarks.kind)});
  return search;
}

// Lines that the segment does not describe in the view's kind give none.
KindSearch SearchLines(const View& view, const Segment& segment) {
  if (view.lines.descriptors.kind != segment.lines.descriptors.kind) return {};
  return SearchKind(view.lines.descriptors, segment.lines.descriptors,
                    segment.lines.descriptor_landmark);
}

}  // namespace

// Generous, because RANSAC stands wrong matches better than missing ones. LBD's was not measured.
float MaxRatio(const DescriptorKind& kind) {
  if (kind.metric == DescriptorMetric::kL2U8) return 0.85f;
  return kind.name == "lbd" ? 0.9f : 0.95f;
}

Matches MatchSegment(const View& view, const Segment& segment) {
  return SearchSegment(view, segment).matches;
}

SegmentSearch SearchSegment(const View& view, const Segment& segment) {
  KindSearch points = SearchKind(view.points.descriptors, segment.points.descriptors,
                                 segment.points.descriptor_landmark);
  KindSearch lines = SearchLines(view, segment);
  return {{std::move(points.matches), std::move(lines.matches)},
          std::move(points.neighbours),
          std::move(lines.neighbours)};
}

Matches MatchSample(const View& view, const Segment& segment, int point_count) {
  const Descriptors& landmarks = segment.points.descriptors;
  if (landmarks.size() == 0) return {{}, SearchLines(view, segment).matches};
  return {MatchSome(view.points.descriptors,
                    EvenSample(view.points.descriptors.size(), point_count), landmarks,
                    segment.points.descriptor_landmark, {.max_ratio = MaxRatio(landmarks.kind)}),
          SearchLines(view, segment).matches};
}

}  // namespace maploc
