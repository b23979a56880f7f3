#include "mapstore/statistics/carry_over.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "mapstore/base/median.h"

namespace maploc {
namespace {

constexpr double kToleranceOfDistance = 0.01;

// Distinct landmarks of one version, and the segments that hold each.
struct Landmarks {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::vector<SegmentId>> segments;  // one list a landmark, ascending
  std::unordered_map<LandmarkId, int> index;
  std::map<SegmentId, std::size_t> sizes;  // landmarks of each segment

  explicit Landmarks(std::span<const SegmentLandmarks> all) {
    for (const SegmentLandmarks& segment : all) {
      sizes[segment.segment] = segment.ids.size();
      for (std::size_t i = 0; i < segment.ids.size(); ++i) {
        const int next = static_cast<int>(positions.size());
        const auto [found, is_new] = index.try_emplace(segment.ids[i], next);
        if (is_new) {
          positions.push_back(segment.positions[i]);
          segments.emplace_back();
        }
        segments[static_cast<std::size_t>(found->second)].push_back(segment.segment);
      }
    }
  }
};

// Cubes of the tolerance's size: what is near enough is in the same or in a neighbouring one.
class Grid {
 public:
  Grid(const std::vector<Eigen::Vector3d>& positions, double tolerance)
      : positions_(positions), tolerance_(tolerance) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      cells_[CellOf(positions[i])].push_back(static_cast<int>(i));
    }
  }

  // Index, or -1. Between equals the first.
  int Nearest(const Eigen::Vector3d& position) const {
    int nearest = -1;
    double best = tolerance_ * tolerance_;
    const Cell at = CellOf(position);
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      // std::div, because clang-tidy takes an integer quotient among doubles for a loss of
      // precision.
      const std::div_t plane = std::div(neighbour, 9);
      const std::div_t row = std::div(plane.rem, 3);
      const auto found =
          cells_.find({at[0] + row.rem - 1, at[1] + row.quot - 1, at[2] + plane.quot - 1});
      if (found == cells_.end()) continue;
      for (const int i : found->second) {
        const double distance = (positions_[static_cast<std::size_t>(i)] - position).squaredNorm();
        if (distance < best || (distance == best && (nearest < 0 || i < nearest))) {
          best = distance;
          nearest = i;
        }
      }
    }
    return nearest;
  }

  void Remove(int i) { std::erase(cells_.at(CellOf(positions_[static_cast<std::size_t>(i)])), i); }

 private:
  using Cell = std::array<double, 3>;  // whole numbers: a map may be far larger than a cell
  Cell CellOf(const Eigen::Vector3d& position) const {
    return {std::floor(position.x() / tolerance_), std::floor(position.y() / tolerance_),
            std::floor(position.z() / tolerance_)};
  }

  const std::vector<Eigen::Vector3d>& positions_;
  const double tolerance_;
  std::map<Cell, std::vector<int>> cells_;
};

// For each old landmark the new one that it is, or -1. Pairs are taken until none is left: of
// landmarks at one place, each finds one. From each landmark a chain of nearest ones is followed to
// a mutual pair; on the way distances fall, so that it ends.
std::vector<int> MatchLandmarks(const Landmarks& old_ones, const Landmarks& new_ones,
                                double tolerance) {
  Grid old_grid(old_ones.positions, tolerance);
  Grid new_grid(new_ones.positions, tolerance);
  std::vector<int> matches(old_ones.positions.size(), -1);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (matches[i] >= 0) continue;
    std::vector<int> chain = {static_cast<int>(i)};
    while (!chain.empty()) {
      const auto last = static_cast<std::size_t>(chain.back());
      const int there = new_grid.Nearest(old_ones.positions[last]);
      if (there < 0) {
        chain.pop_back();
        continue;
      }
      const int back = old_grid.Nearest(new_ones.positions[static_cast<std::size_t>(there)]);
      if (back != chain.back()) {
        chain.push_back(back);
        continue;
      }
      matches[last] = there;
      old_grid.Remove(back);
      new_grid.Remove(there);
      chain.pop_back();
    }
  }
  return matches;
}

// The new segments that hold landmarks of one old segment, in the order of their claim to a
// landmark that several of them hold. An identical segment comes first: it shares all and holds
// nothing else.
std::map<SegmentId, std::size_t> RankHolders(SegmentId old_segment, std::span<const int> matches,
                                             const Landmarks& new_ones) {
  std::map<SegmentId, std::int64_t> shared;
  for (const int match : matches) {
    for (const SegmentId holder : new_ones.segments[static_cast<std::size_t>(match)]) {
      ++shared[holder];
    }
  }
  std::vector<std::tuple<std::int64_t, std::size_t, bool, SegmentId>> claims;
  for (const auto& [holder, count] : shared) {
    claims.emplace_back(-count, new_ones.sizes.at(holder), holder != old_segment, holder);
  }
  std::sort(claims.begin(), claims.end());
  std::map<SegmentId, std::size_t> ranks;
  for (std::size_t i = 0; i < claims.size(); ++i) ranks[std::get<SegmentId>(claims[i])] = i;
  return ranks;
}

}  // namespace

SegmentLandmarks LandmarksOf(const Segment& segment, const Similarity3& new_map_from_map) {
  SegmentLandmarks landmarks;
  landmarks.segment = segment.id;
  landmarks.ids = segment.points.ids;
  for (const Eigen::Vector3d& position : segment.points.positions_in_map) {
    landmarks.positions.push_back(new_map_from_map * position);
  }
  for (std::size_t i = 0; i < segment.lines.ids.size(); ++i) {
    const LineSegment3& line = segment.lines.segments_in_map[i];
    landmarks.ids.push_back(-1 - segment.lines.ids[i]);
    landmarks.positions.push_back(new_map_from_map *
                                  Eigen::Vector3d(0.5 * (line.start + line.end)));
  }
  return landmarks;
}

double SharedLandmarkTolerance(std::span<const Segment> segments) {
  std::vector<double> distances;
  for (const Segment& segment : segments) {
    if (segment.path_in_map.empty()) continue;
    for (const Eigen::Vector3d& landmark : segment.points.positions_in_map) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Eigen::Vector3d& frame : segment.path_in_map) {
        nearest = std::min(nearest, (landmark - frame).norm());
      }
      distances.push_back(nearest);
    }
  }
  if (distances.empty()) return 0.0;
  return kToleranceOfDistance * UpperMedian(std::move(distances));
}

std::vector<CarriedShare> CarryOver(std::span<const SegmentLandmarks> old_segments,
                                    std::span<const SegmentLandmarks> new_segments,
                                    double tolerance) {
  if (!(tolerance > 0.0)) return {};
  const Landmarks old_ones(old_segments);
  const Landmarks new_ones(new_segments);
  const std::vector<int> matches = MatchLandmarks(old_ones, new_ones, tolerance);
  std::vector<CarriedShare> shares;
  for (const SegmentLandmarks& segment : old_segments) {
    std::vector<int> found;
    for (const LandmarkId id : segment.ids) {
      const int match = matches[static_cast<std::size_t>(old_ones.index.at(id))];
      if (match >= 0) found.push_back(match);
    }
    const auto ranks = RankHolders(segment.segment, found, new_ones);
    std::map<SegmentId, std::int64_t> landmarks;
    for (const int match : found) {
      const auto& holders = new_ones.segments[static_cast<std::size_t>(match)];
      ++landmarks[*std::min_element(holders.begin(), holders.end(), [&](SegmentId a, SegmentId b) {
        return ranks.at(a) < ranks.at(b);
      })];
    }
    for (const auto& [to, count] : landmarks) {
      // Of all its landmarks: those that no longer exist leave a share that nobody inherits.
      const double weight = static_cast<double>(count) / static_cast<double>(segment.ids.size());
      shares.push_back({segment.segment, to, weight});
    }
  }
  return shares;
}

}  // namespace maploc
