#include "server/matching/segment_matching.h"

namespace maploc {
namespace {

std::vector<FeatureMatch> MatchKind(const Descriptors& features, const Descriptors& landmarks,
                                    const std::vector<std::int32_t>& row_landmark) {
  if (features.size() == 0 || landmarks.size() == 0) return {};
  return MatchDescriptors(features, landmarks, row_landmark,
                          {.max_ratio = MaxRatio(landmarks.kind), .mutual = true});
}

}  // namespace

float MaxRatio(const DescriptorKind& kind) {
  if (kind.metric == DescriptorMetric::kL2U8) return 0.85f;
  return kind.name == "lbd" ? 0.9f : 0.95f;
}

Matches MatchSegment(const View& view, const Segment& segment) {
  const bool comparable_lines = view.lines.descriptors.kind == segment.lines.descriptors.kind;
  Matches matches;
  matches.points = MatchKind(view.points.descriptors, segment.points.descriptors,
                             segment.points.descriptor_landmark);
  if (comparable_lines) {
    matches.lines = MatchKind(view.lines.descriptors, segment.lines.descriptors,
                              segment.lines.descriptor_landmark);
  }
  return matches;
}

}  // namespace maploc
