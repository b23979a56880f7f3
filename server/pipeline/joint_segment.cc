#include "server/pipeline/joint_segment.h"

#include <algorithm>
#include <utility>

#include "mapstore/geometry/line.h"

namespace maploc {
namespace {

struct Source {
  LandmarkId id = 0;
  int segment = 0;   // index into the segments that are joined
  int landmark = 0;  // index in that segment
};

// Ascending by id, each id with the first segment that holds it.
template <typename Landmarks>
std::vector<Source> DistinctLandmarks(const std::vector<const Landmarks*>& parts) {
  std::vector<Source> sources;
  for (int segment = 0; segment < static_cast<int>(parts.size()); ++segment) {
    for (int landmark = 0; landmark < parts[segment]->size(); ++landmark) {
      sources.push_back({parts[segment]->ids[landmark], segment, landmark});
    }
  }
  std::stable_sort(sources.begin(), sources.end(),
                   [](const Source& a, const Source& b) { return a.id < b.id; });
  const auto end = std::unique(sources.begin(), sources.end(),
                               [](const Source& a, const Source& b) { return a.id == b.id; });
  sources.erase(end, sources.end());
  return sources;
}

const std::vector<Eigen::Vector3d>& Geometry(const PointLandmarks& points) {
  return points.positions_in_map;
}
std::vector<Eigen::Vector3d>& Geometry(PointLandmarks& points) { return points.positions_in_map; }
const std::vector<LineSegment3>& Geometry(const LineLandmarks& lines) {
  return lines.segments_in_map;
}
std::vector<LineSegment3>& Geometry(LineLandmarks& lines) { return lines.segments_in_map; }

// The rows of `landmark`, which stand together, become those of the last one of `joint`.
template <typename Landmarks>
void AppendRows(const Landmarks& part, int landmark, Landmarks& joint) {
  const std::vector<std::int32_t>& rows = part.descriptor_landmark;
  const auto [first, last] = std::equal_range(rows.begin(), rows.end(), landmark);
  for (auto row = first; row != last; ++row) {
    const auto bytes = part.descriptors.row(static_cast<int>(row - rows.begin()));
    joint.descriptors.bytes.insert(joint.descriptors.bytes.end(), bytes.begin(), bytes.end());
    joint.descriptor_landmark.push_back(joint.size() - 1);
  }
}

// From where landmarks were seen. All parts must know it: an unknown range says that the landmark
// can be seen from everywhere.
template <typename Landmarks>
void JoinViewing(const std::vector<const Landmarks*>& parts, const std::vector<Source>& sources,
                 Landmarks& joint) {
  const bool known = std::all_of(parts.begin(), parts.end(), [](const Landmarks* part) {
    return part->viewing.size() == part->ids.size();
  });
  if (!known) return;
  for (const Source& source : sources) {
    joint.viewing.push_back(parts[source.segment]->viewing[source.landmark]);
  }
}

template <typename Landmarks>
Landmarks Join(const std::vector<const Landmarks*>& parts) {
  Landmarks joint;
  for (const Landmarks* part : parts) {
    // A segment without such landmarks may have no kind.
    if (joint.descriptors.kind.bytes == 0) joint.descriptors.kind = part->descriptors.kind;
  }
  const std::vector<Source> sources = DistinctLandmarks(parts);
  for (const Source& source : sources) {
    const Landmarks& part = *parts[source.segment];
    joint.ids.push_back(source.id);
    Geometry(joint).push_back(Geometry(part)[source.landmark]);
    AppendRows(part, source.landmark, joint);
  }
  JoinViewing(parts, sources, joint);
  return joint;
}

// Matches with a part's landmarks, and whether they are inliers.
struct Told {
  std::vector<FeatureMatch> matches;
  std::vector<std::uint8_t> inlier;

  std::int32_t Inliers() const {
    return static_cast<std::int32_t>(std::count(inlier.begin(), inlier.end(), 1));
  }
};

Told MatchesOfPart(const std::vector<FeatureMatch>& matches,
                   const std::vector<std::uint8_t>& inlier, const std::vector<LandmarkId>& ids,
                   const std::vector<LandmarkId>& part_ids) {
  Told told;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const LandmarkId id = ids[matches[i].landmark];
    const auto place = std::lower_bound(part_ids.begin(), part_ids.end(), id);
    if (place == part_ids.end() || *place != id) continue;
    const auto landmark = static_cast<std::int32_t>(place - part_ids.begin());
    told.matches.push_back({matches[i].feature, landmark, matches[i].ratio});
    told.inlier.push_back(inlier[i]);
  }
  return told;
}

void CountLines(const Told& told, const LineLandmarks& lines, Evidence& evidence) {
  evidence.usable_lines = evidence.vertical_lines = {};
  for (std::size_t i = 0; i < told.matches.size(); ++i) {
    const bool usable = IsUsableLine(lines.segments_in_map[told.matches[i].landmark]);
    FeatureCounts& counts = usable ? evidence.usable_lines : evidence.vertical_lines;
    ++counts.matches;
    counts.inliers += told.inlier[i];
  }
}

}  // namespace

Segment JoinSegments(const std::vector<std::shared_ptr<const Segment>>& segments) {
  std::vector<const PointLandmarks*> points;
  std::vector<const LineLandmarks*> lines;
  for (const std::shared_ptr<const Segment>& segment : segments) {
    points.push_back(&segment->points);
    lines.push_back(&segment->lines);
  }
  const Segment& first = *segments.front();
  return {first.map, first.id, first.path_in_map, Join(points), Join(lines)};
}

void TellOfOnePart(const Segment& joint, const std::vector<std::shared_ptr<const Segment>>& parts,
                   Localization& answer) {
  const Segment* best = nullptr;
  Told points;
  Told lines;
  for (const std::shared_ptr<const Segment>& part : parts) {
    Told part_points = MatchesOfPart(answer.matches.points, answer.point_match_inlier,
                                     joint.points.ids, part->points.ids);
    Told part_lines = MatchesOfPart(answer.matches.lines, answer.line_match_inlier, joint.lines.ids,
                                    part->lines.ids);
    if (best != nullptr &&
        part_points.Inliers() + part_lines.Inliers() <= points.Inliers() + lines.Inliers()) {
      continue;
    }
    best = part.get();
    points = std::move(part_points);
    lines = std::move(part_lines);
  }
  answer.segment = best->id;
  answer.evidence.points = {static_cast<std::int32_t>(points.matches.size()), points.Inliers()};
  CountLines(lines, best->lines, answer.evidence);
  answer.matches = {std::move(points.matches), std::move(lines.matches)};
  answer.point_match_inlier = std::move(points.inlier);
  answer.line_match_inlier = std::move(lines.inlier);
}

}  // namespace maploc
