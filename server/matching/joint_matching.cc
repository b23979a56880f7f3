#include "server/matching/joint_matching.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace maploc {
namespace {

// The searches of one kind of feature in one segment.
struct Part {
  const std::vector<LandmarkId>& ids;
  const std::vector<FeatureMatch>& matches;
  const std::vector<Neighbours>& neighbours;
};

// The nearest landmark of all parts, and the nearest other one.
struct JointNeighbours {
  LandmarkId id = 0;
  Neighbours neighbours;  // `best` is 0 if there is one

  void Add(LandmarkId other_id, const Neighbours& other) {
    Neighbours& own = neighbours;
    if (own.best < 0) {
      id = other_id;
      own = {0, other.best_distance, other.second_distance};
    } else if (other_id == id) {
      own.best_distance = std::min(own.best_distance, other.best_distance);
      own.second_distance = std::min(own.second_distance, other.second_distance);
    } else if (other.best_distance < own.best_distance) {
      const std::uint32_t second = std::min(own.best_distance, other.second_distance);
      id = other_id;
      own = {0, other.best_distance, second};
    } else {
      // The other part's second is no nearer than its best.
      own.second_distance = std::min(own.second_distance, other.best_distance);
    }
  }
};

std::vector<JointNeighbours> JoinNeighbours(const std::vector<Part>& parts) {
  std::vector<JointNeighbours> joint;
  for (const Part& part : parts) {
    joint.resize(std::max(joint.size(), part.neighbours.size()));
    for (std::size_t feature = 0; feature < part.neighbours.size(); ++feature) {
      const Neighbours& found = part.neighbours[feature];
      if (found.best >= 0) joint[feature].Add(part.ids[found.best], found);
    }
  }
  return joint;
}

std::vector<FeatureMatch> MatchKind(const std::vector<Part>& parts,
                                    const std::vector<LandmarkId>& joint_ids,
                                    const DescriptorKind& kind) {
  const std::vector<JointNeighbours> joint = JoinNeighbours(parts);
  std::vector<FeatureMatch> matches;
  for (const Part& part : parts) {
    for (const FeatureMatch& match : part.matches) {
      const JointNeighbours& nearest = joint[match.feature];
      if (part.ids[match.landmark] != nearest.id ||
          !PassesRatio(nearest.neighbours, kind.metric, MaxRatio(kind))) {
        continue;
      }
      // There: the joint segment has the landmarks of all parts, ascending.
      const auto place = std::ranges::lower_bound(joint_ids, nearest.id) - joint_ids.begin();
      matches.push_back({match.feature, static_cast<std::int32_t>(place),
                         static_cast<float>(RatioOf(nearest.neighbours, kind.metric))});
    }
  }
  std::ranges::sort(matches, {}, &FeatureMatch::feature);
  // Of a landmark in several parts there are several.
  const auto end = std::unique(
      matches.begin(), matches.end(),
      [](const FeatureMatch& a, const FeatureMatch& b) { return a.feature == b.feature; });
  matches.erase(end, matches.end());
  return matches;
}

}  // namespace

Matches MatchJointly(const std::vector<SearchedSegment>& parts, const Segment& joint) {
  std::vector<Part> points;
  std::vector<Part> lines;
  for (const auto& [segment, search] : parts) {
    points.push_back({segment->points.ids, search->matches.points, search->points});
    lines.push_back({segment->lines.ids, search->matches.lines, search->lines});
  }
  return {MatchKind(points, joint.points.ids, joint.points.descriptors.kind),
          MatchKind(lines, joint.lines.ids, joint.lines.descriptors.kind)};
}

}  // namespace maploc
