#include "mapstore/importers/line_candidates.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace maploc {
namespace {

constexpr int kMaxCandidates = 10;  // of one segment in one neighbouring frame
// Between a ray and the other view's plane (1.5 degrees): below, the depth is not determined.
constexpr double kMinPlaneAngleRad = 0.026;

// The baseline architecture has no popcount instruction, and the compiler's stand-in looks up a
// table a byte; this counts in the word (Warren, Hacker's Delight, 5-1).
int CountBits(std::uint64_t x) {
  x -= (x >> 1) & 0x5555555555555555u;
  x = (x & 0x3333333333333333u) + ((x >> 2) & 0x3333333333333333u);
  x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  return static_cast<int>((x * 0x0101010101010101u) >> 56);
}

}  // namespace

LineViews::LineViews(std::span<const KeyFrame> frames, std::span<const FrameLines> lines)
    : frames_(frames), lines_(lines) {
  for (const KeyFrame& frame : frames) focal_px_.push_back(frame.FocalLengthInFeaturePixels());
  for (const FrameLines& of_frame : lines) {
    std::vector<Words> words(of_frame.normalized.size());
    for (std::size_t i = 0; i < words.size(); ++i) {
      std::memcpy(words[i].data(), of_frame.descriptors.row(static_cast<int>(i)).data(),
                  sizeof(Words));
    }
    words_.push_back(std::move(words));
  }
}

int LineViews::DescriptorDistance(LineRef a, LineRef b) const {
  const Words& words_a = DescriptorWords(a);
  const Words& words_b = DescriptorWords(b);
  int distance = 0;
  for (std::size_t i = 0; i < words_a.size(); ++i) {
    distance += CountBits(words_a[i] ^ words_b[i]);
  }
  return distance;
}

std::vector<LineCandidate> FindLineCandidates(const LineViews& views, LineRef line,
                                              int other_frame) {
  std::vector<std::pair<int, LineRef>> near;
  for (std::int32_t m = 0; m < views.LineCount(other_frame); ++m) {
    const LineRef other{other_frame, m};
    const int distance = views.DescriptorDistance(line, other);
    if (distance <= kMaxDescriptorDistance) near.emplace_back(distance, other);
  }
  std::sort(near.begin(), near.end());
  const LineObservation seen = views.Observation(line);
  std::vector<LineCandidate> candidates;
  for (const auto& [distance, other] : near) {
    if (static_cast<int>(candidates.size()) == kMaxCandidates) break;
    const LineObservation other_seen = views.Observation(other);
    const std::optional<LineSegment3> line_in_map =
        IntersectPlanes(seen, other_seen, kMinPlaneAngleRad);
    // The error is 0 by construction; what is asked is the overlap along the line.
    if (line_in_map && ShowsLine(other_seen, *line_in_map, kMaxVoteErrorPx, kMinOverlap)) {
      candidates.push_back({other, distance, *line_in_map});
    }
  }
  return candidates;
}

}  // namespace maploc
