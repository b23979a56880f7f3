#include "mapstore/importers/segmenter.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>

#include "mapstore/base/median.h"
#include "mapstore/importers/landmark_views.h"

namespace maploc {
namespace {

constexpr double kOverlap = 0.25;     // of a stretch's length, added at each end
constexpr int kMinOverlapFrames = 2;  // added at each end, however far apart

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

std::string_view TakeDigits(std::string_view& text) {
  std::size_t count = 0;
  while (count < text.size() && IsDigit(text[count])) ++count;
  std::string_view digits = text.substr(0, count);
  text.remove_prefix(count);
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

// Numbers compare by value, however long.
bool NaturallyBefore(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (IsDigit(a[0]) && IsDigit(b[0])) {
      const std::string_view number_a = TakeDigits(a);
      const std::string_view number_b = TakeDigits(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else {
      if (a[0] != b[0]) return a[0] < b[0];
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return a.size() < b.size();
}

std::vector<Eigen::Vector3d> Centers(std::span<const KeyFrame> frames) {
  std::vector<Eigen::Vector3d> centers;
  for (const KeyFrame& frame : frames) centers.push_back(frame.CenterInMap());
  return centers;
}

double PathLength(const std::vector<Eigen::Vector3d>& centers, const std::vector<int>& order) {
  double length = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    length += (centers[static_cast<std::size_t>(order[i])] -
               centers[static_cast<std::size_t>(order[i - 1])])
                  .norm();
  }
  return length;
}

std::vector<int> ChainNearest(const std::vector<Eigen::Vector3d>& centers) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& center : centers) {
    middle += center / static_cast<double>(centers.size());
  }
  std::vector<int> left(centers.size());
  std::iota(left.begin(), left.end(), 0);
  const auto distance = [&](const Eigen::Vector3d& from) {
    return [&centers, from](int a, int b) {
      return (centers[static_cast<std::size_t>(a)] - from).squaredNorm() <
             (centers[static_cast<std::size_t>(b)] - from).squaredNorm();
    };
  };
  std::vector<int> order;
  auto next = std::max_element(left.begin(), left.end(), distance(middle));
  while (next != left.end()) {
    order.push_back(*next);
    left.erase(next);
    next = std::min_element(left.begin(), left.end(),
                            distance(centers[static_cast<std::size_t>(order.back())]));
  }
  return order;
}

// The landmarks that one of the frames saw, as indices.
template <typename Track>
std::vector<int> SeenBy(const std::vector<char>& in_segment, std::span<const Track> tracks) {
  std::vector<int> seen;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const bool is_seen = std::any_of(
        tracks[i].frames.begin(), tracks[i].frames.end(),
        [&](std::int32_t frame) { return in_segment[static_cast<std::size_t>(frame)] != 0; });
    if (is_seen) seen.push_back(static_cast<int>(i));
  }
  return seen;
}

template <typename Track, typename Landmarks>
void AppendLandmark(int id, const Track& track, Landmarks& landmarks) {
  const auto index = static_cast<std::int32_t>(landmarks.ids.size());
  landmarks.ids.push_back(id);
  Descriptors& descriptors = landmarks.descriptors;
  descriptors.bytes.insert(descriptors.bytes.end(), track.descriptors.begin(),
                           track.descriptors.end());
  landmarks.descriptor_landmark.resize(static_cast<std::size_t>(descriptors.size()), index);
}

}  // namespace

std::vector<int> OrderAlongPath(std::span<const KeyFrame> frames) {
  constexpr double kMaxDetour = 2.0;
  std::vector<int> by_name(frames.size());
  std::iota(by_name.begin(), by_name.end(), 0);
  std::sort(by_name.begin(), by_name.end(), [&](int a, int b) {
    const std::string& name_a = frames[static_cast<std::size_t>(a)].name;
    const std::string& name_b = frames[static_cast<std::size_t>(b)].name;
    if (NaturallyBefore(name_a, name_b)) return true;
    return !NaturallyBefore(name_b, name_a) && name_a < name_b;
  });
  const std::vector<Eigen::Vector3d> centers = Centers(frames);
  const std::vector<int> by_place = ChainNearest(centers);
  const bool is_path =
      PathLength(centers, by_name) <= kMaxDetour * PathLength(centers, by_place) + 1e-9;
  return is_path ? by_name : by_place;
}

double DefaultSegmentLength(std::span<const KeyFrame> frames, std::span<const PointTrack> points) {
  constexpr double kDepths = 2.0;
  std::vector<double> depths;
  for (const PointTrack& point : points) {
    for (const std::int32_t frame : point.frames) {
      const KeyFrame& seen_by = frames[static_cast<std::size_t>(frame)];
      depths.push_back((point.position_in_map - seen_by.CenterInMap()).norm());
    }
  }
  if (depths.empty()) return 0.0;
  return kDepths * UpperMedian(std::move(depths));
}

std::vector<std::vector<int>> CutPath(std::span<const KeyFrame> frames,
                                      const std::vector<int>& order, double length) {
  const std::vector<Eigen::Vector3d> centers = Centers(frames);
  std::vector<double> distance;  // along the path, one a place in `order`
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::vector<int> step(order.begin() + static_cast<std::ptrdiff_t>(i > 0 ? i - 1 : 0),
                                order.begin() + static_cast<std::ptrdiff_t>(i + 1));
    distance.push_back((i > 0 ? distance.back() : 0.0) + PathLength(centers, step));
  }
  const double total = distance.empty() ? 0.0 : distance.back();
  // No more stretches than frames, so that a tiny length asks for no memory.
  const double wanted = length > 0 ? std::ceil(total / length) : 1.0;
  const int count = static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(order.size())));
  const double stretch = total / count;
  std::vector<std::vector<int>> segments;
  const int last_place = static_cast<int>(order.size()) - 1;
  for (int first = 0; first <= last_place;) {
    const auto stretch_of = [&](int place) {
      if (!(stretch > 0)) return 0;
      return std::min(static_cast<int>(distance[static_cast<std::size_t>(place)] / stretch),
                      count - 1);
    };
    int last = first;
    while (last < last_place && stretch_of(last + 1) == stretch_of(first)) ++last;
    const double margin = kOverlap * stretch;
    int from = std::max(0, first - kMinOverlapFrames);
    int to = std::min(last_place, last + kMinOverlapFrames);
    const auto at = [&](int place) { return distance[static_cast<std::size_t>(place)]; };
    while (from > 0 && at(first) - at(from - 1) <= margin) --from;
    while (to < last_place && at(to + 1) - at(last) <= margin) ++to;
    segments.emplace_back(order.begin() + from, order.begin() + to + 1);
    first = last + 1;
  }
  return segments;
}

Segment MakeSegment(SegmentId id, const std::vector<int>& segment_frames,
                    std::span<const KeyFrame> frames, std::span<const PointTrack> points,
                    const DescriptorKind& point_kind, std::span<const LineTrackInMap> lines,
                    const DescriptorKind& line_kind) {
  Segment segment;
  segment.id = id;
  std::vector<char> in_segment(frames.size(), 0);
  for (const int frame : segment_frames) {
    in_segment[static_cast<std::size_t>(frame)] = 1;
    segment.path_in_map.push_back(frames[static_cast<std::size_t>(frame)].CenterInMap());
  }
  segment.points.descriptors.kind = point_kind;
  for (const int i : SeenBy(in_segment, points)) {
    const PointTrack& track = points[static_cast<std::size_t>(i)];
    const Eigen::Vector3d& position = track.position_in_map;
    segment.points.positions_in_map.push_back(position);
    segment.points.viewing.push_back(ViewingFromFrames(position, frames, track.frames));
    AppendLandmark(i, track, segment.points);
  }
  segment.lines.descriptors.kind = line_kind;
  for (const int i : SeenBy(in_segment, lines)) {
    const LineTrackInMap& track = lines[static_cast<std::size_t>(i)];
    const LineSegment3& line = track.segment_in_map;
    segment.lines.segments_in_map.push_back(line);
    segment.lines.viewing.push_back(
        ViewingFromFrames((line.start + line.end) / 2, frames, track.frames));
    AppendLandmark(i, track, segment.lines);
  }
  return segment;
}

}  // namespace maploc
