#include "mapstore/importers/line_candidates.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace maploc {

LineObservation LineViews::Observation(LineRef ref) const {
  const KeyFrame& frame = frames_[static_cast<std::size_t>(ref.frame)];
  return {frame.camera_from_map, Lines(ref.frame).normalized[static_cast<std::size_t>(ref.line)],
          frame.camera.MeanFocalLengthPx()};
}

int LineViews::DescriptorDistance(LineRef a, LineRef b) const {
  const std::span<const std::uint8_t> row_a = Descriptor(a);
  const std::span<const std::uint8_t> row_b = Descriptor(b);
  int distance = 0;
  for (std::size_t i = 0; i < row_a.size(); i += 8) {
    std::uint64_t word_a = 0;
    std::uint64_t word_b = 0;
    const std::size_t bytes = std::min<std::size_t>(8, row_a.size() - i);
    std::memcpy(&word_a, &row_a[i], bytes);
    std::memcpy(&word_b, &row_b[i], bytes);
    distance += std::popcount(word_a ^ word_b);
  }
  return distance;
}

std::vector<LineCandidate> FindLineCandidates(const LineViews& views, LineRef line, int other_frame,
                                              const LineTriangulationOptions& options) {
  std::vector<std::pair<int, LineRef>> near;
  for (std::int32_t m = 0; m < views.LineCount(other_frame); ++m) {
    const LineRef other{other_frame, m};
    const int distance = views.DescriptorDistance(line, other);
    if (distance <= options.max_descriptor_distance) near.emplace_back(distance, other);
  }
  std::sort(near.begin(), near.end());
  const LineObservation seen = views.Observation(line);
  std::vector<LineCandidate> candidates;
  for (const auto& [distance, other] : near) {
    if (static_cast<int>(candidates.size()) == options.max_candidates) break;
    const LineObservation other_seen = views.Observation(other);
    const std::optional<LineSegment3> line_in_map =
        IntersectPlanes(seen, other_seen, options.min_plane_angle_rad);
    // The error is 0 by construction; what is asked is the overlap along the line.
    if (line_in_map &&
        ShowsLine(other_seen, *line_in_map, options.max_vote_error_px, options.min_overlap)) {
      candidates.push_back({other, distance, *line_in_map});
    }
  }
  return candidates;
}

}  // namespace maploc
