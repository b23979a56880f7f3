#include "server/matching/segment_matching.h"

#include "mapstore/base/even_sample.h"

namespace maploc {
namespace {

std::vector<FeatureMatch> MatchKind(const Descriptors& features, const Descriptors& landmarks,
                                    const std::vector<std::int32_t>& row_landmark) {
  if (features.size() == 0 || landmarks.size() == 0) return {};
  return MatchDescriptors(features, landmarks, row_landmark,
                          {.max_ratio = MaxRatio(landmarks.kind), .mutual = true});
}

// Lines that the segment does not describe in the view's kind give none.
std::vector<FeatureMatch> MatchLines(const View& view, const Segment& segment) {
  if (view.lines.descriptors.kind != segment.lines.descriptors.kind) return {};
  return MatchKind(view.lines.descriptors, segment.lines.descriptors,
                   segment.lines.descriptor_landmark);
}

}  // namespace

float MaxRatio(const DescriptorKind& kind) {
  if (kind.metric == DescriptorMetric::kL2U8) return 0.85f;
  return kind.name == "lbd" ? 0.9f : 0.95f;
}

Matches MatchSegment(const View& view, const Segment& segment) {
  return {MatchKind(view.points.descriptors, segment.points.descriptors,
                    segment.points.descriptor_landmark),
          MatchLines(view, segment)};
}

Matches MatchSample(const View& view, const Segment& segment, int point_count) {
  const Descriptors& landmarks = segment.points.descriptors;
  if (landmarks.size() == 0) return {{}, MatchLines(view, segment)};
  return {MatchSome(view.points.descriptors,
                    EvenSample(view.points.descriptors.size(), point_count), landmarks,
                    segment.points.descriptor_landmark, {.max_ratio = MaxRatio(landmarks.kind)}),
          MatchLines(view, segment)};
}

}  // namespace maploc
