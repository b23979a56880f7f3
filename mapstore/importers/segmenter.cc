#include "mapstore/importers/segmenter.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "mapstore/base/median.h"
#include "mapstore/importers/frame_order.h"
#include "mapstore/importers/landmark_views.h"
#include "mapstore/importers/photo_groups.h"

namespace maploc {
namespace {

constexpr double kOverlap = 0.25;     // of a stretch's length, added at each end
constexpr int kMinOverlapFrames = 2;  // added at each end, however far apart

template <typename Track, typename Landmarks>
void AppendLandmark(int id, const Track& track, Landmarks& landmarks) {
  const auto index = static_cast<std::int32_t>(landmarks.ids.size());
  landmarks.ids.push_back(id);
  Descriptors& descriptors = landmarks.descriptors;
  descriptors.bytes.insert(descriptors.bytes.end(), track.descriptors.begin(),
                           track.descriptors.end());
  // resize() gives the index to the new rows alone.
  landmarks.descriptor_landmark.resize(static_cast<std::size_t>(descriptors.size()), index);
}

}  // namespace

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
  std::vector<double> distance;  // along the path, one a place in `order`
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::vector<int> step(order.begin() + static_cast<std::ptrdiff_t>(i > 0 ? i - 1 : 0),
                                order.begin() + static_cast<std::ptrdiff_t>(i + 1));
    distance.push_back((i > 0 ? distance.back() : 0.0) + PathLength(frames, step));
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

std::vector<std::vector<int>> CutIntoSegments(std::span<const KeyFrame> frames,
                                              std::span<const PointTrack> points, double length) {
  if (const auto order = RecordedOrder(frames)) return CutPath(frames, *order, length);
  // As wide as a path's segment with what is added at both ends.
  std::vector<std::vector<int>> groups =
      GroupPhotos(frames, points, (1.0 + 2.0 * kOverlap) * length);
  for (std::vector<int>& group : groups) group = OrderByNearness(frames, group);
  return groups;
}

template <typename Track>
SegmentMaker::Seen::Seen(std::size_t frames, std::span<const Track> tracks) : begin(frames + 1, 0) {
  // The tracks of each frame stand together in one list, so that a segment looks at nothing but
  // what its frames saw. Looking through all tracks for each segment makes an import's time grow
  // with the square of the map's length.
  for (const Track& track : tracks) {
    for (const std::int32_t frame : track.frames) ++begin[frame + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  landmarks.resize(begin.back());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (const std::int32_t frame : tracks[i].frames) {
      landmarks[next[frame]++] = static_cast<int>(i);
    }
  }
}

std::vector<int> SegmentMaker::Seen::By(const std::vector<int>& frames) const {
  std::vector<int> seen;
  for (const int frame : frames) {
    seen.insert(seen.end(), landmarks.begin() + static_cast<std::ptrdiff_t>(begin[frame]),
                landmarks.begin() + static_cast<std::ptrdiff_t>(begin[frame + 1]));
  }
  std::ranges::sort(seen);
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

SegmentMaker::SegmentMaker(std::span<const KeyFrame> frames, const TracksOfKind<PointTrack>& points,
                           const TracksOfKind<LineTrackInMap>& lines)
    : frames_(frames),
      points_(points),
      lines_(lines),
      points_seen_(frames.size(), points.tracks),
      lines_seen_(frames.size(), lines.tracks) {}

Segment SegmentMaker::Make(SegmentId id, const std::vector<int>& segment_frames) const {
  Segment segment;
  segment.id = id;
  for (const int frame : segment_frames) {
    segment.path_in_map.push_back(frames_[frame].CenterInMap());
  }
  segment.points.descriptors.kind = points_.kind;
  for (const int i : points_seen_.By(segment_frames)) {
    const PointTrack& track = points_.tracks[i];
    const Eigen::Vector3d& position = track.position_in_map;
    segment.points.positions_in_map.push_back(position);
    segment.points.viewing.push_back(ViewingFromFrames(position, frames_, track.frames));
    AppendLandmark(i, track, segment.points);
  }
  segment.lines.descriptors.kind = lines_.kind;
  for (const int i : lines_seen_.By(segment_frames)) {
    const LineTrackInMap& track = lines_.tracks[i];
    const LineSegment3& line = track.segment_in_map;
    segment.lines.segments_in_map.push_back(line);
    segment.lines.viewing.push_back(
        ViewingFromFrames((line.start + line.end) / 2, frames_, track.frames));
    AppendLandmark(i, track, segment.lines);
  }
  return segment;
}

}  // namespace maploc
