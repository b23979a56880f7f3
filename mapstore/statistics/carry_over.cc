#include "mapstore/statistics/carry_over.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <unordered_map>

namespace maploc {
namespace {

constexpr double kToleranceOfDistance = 0.01;

// Distinct landmarks of one version, and the segments that hold each.
struct Landmarks {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::vector<SegmentId>> segments;  // one list a landmark, ascending
  std::unordered_map<LandmarkId, int> index;

  explicit Landmarks(std::span<const SegmentLandmarks> all) {
    for (const SegmentLandmarks& segment : all) {
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

// For each old landmark the new one that it is, or -1.
std::vector<int> MatchLandmarks(const Landmarks& old_ones, const Landmarks& new_ones,
                                double tolerance) {
  const Grid old_grid(old_ones.positions, tolerance);
  const Grid new_grid(new_ones.positions, tolerance);
  std::vector<int> matches;
  for (std::size_t i = 0; i < old_ones.positions.size(); ++i) {
    const int there = new_grid.Nearest(old_ones.positions[i]);
    const bool mutual =
        there >= 0 && old_grid.Nearest(new_ones.positions[static_cast<std::size_t>(there)]) ==
                          static_cast<int>(i);
    matches.push_back(mutual ? there : -1);
  }
  return matches;
}

// A new row while the shares are added up.
struct Sum {
  std::array<double, 8> counts{};   // in the order of CountsOf
  std::array<double, 3> medians{};  // times the weight of their queries
};

std::array<std::int64_t, 8> CountsOf(const SegmentSessionRow& row) {
  return {row.queries,
          row.localized,
          row.point_matches,
          row.point_inliers,
          row.usable_line_matches,
          row.usable_line_inliers,
          row.vertical_line_matches,
          row.vertical_line_inliers};
}

void AddShare(const SegmentSessionRow& row, double weight, Sum& sum) {
  const auto counts = CountsOf(row);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    sum.counts[i] += weight * static_cast<double>(counts[i]);
  }
  const double localized = weight * static_cast<double>(row.localized);
  sum.medians[0] += localized * row.median_point_matches;
  sum.medians[1] += localized * row.median_usable_line_matches;
  sum.medians[2] += localized * row.median_vertical_line_matches;
}

// Rounding keeps the order of what is counted: never more inliers than matches.
SegmentSessionRow RowOf(const SegmentSessionRow& of_session, SegmentId segment, const Sum& sum) {
  const auto count = [&](std::size_t i) { return std::llround(sum.counts[i]); };
  SegmentSessionRow row;
  row.session = of_session.session;
  row.session_start_unix_ns = of_session.session_start_unix_ns;
  row.segment = segment;
  row.queries = count(0);
  row.localized = count(1);
  row.point_matches = count(2);
  row.point_inliers = count(3);
  row.usable_line_matches = count(4);
  row.usable_line_inliers = count(5);
  row.vertical_line_matches = count(6);
  row.vertical_line_inliers = count(7);
  const double localized = sum.counts[1];
  if (row.localized == 0 || localized <= 0.0) return row;
  row.median_point_matches = sum.medians[0] / localized;
  row.median_usable_line_matches = sum.medians[1] / localized;
  row.median_vertical_line_matches = sum.medians[2] / localized;
  return row;
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
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return kToleranceOfDistance * *middle;
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
    std::map<SegmentId, double> weights;
    for (const LandmarkId id : segment.ids) {
      const int match = matches[static_cast<std::size_t>(old_ones.index.at(id))];
      if (match < 0) continue;
      const auto& holders = new_ones.segments[static_cast<std::size_t>(match)];
      for (const SegmentId holder : holders) {
        weights[holder] += 1.0 / static_cast<double>(holders.size());
      }
    }
    for (const auto& [to, weight] : weights) {
      shares.push_back({segment.segment, to, weight / static_cast<double>(segment.ids.size())});
    }
  }
  return shares;
}

std::vector<SegmentSessionRow> CarryRows(std::span<const SegmentSessionRow> rows,
                                         std::span<const CarriedShare> shares) {
  std::map<SegmentId, Sum> sums;
  for (const SegmentSessionRow& row : rows) {
    for (const CarriedShare& share : shares) {
      if (share.from == row.segment) AddShare(row, share.weight, sums[share.to]);
    }
  }
  std::vector<SegmentSessionRow> carried;
  for (const auto& [segment, sum] : sums) {
    SegmentSessionRow row = RowOf(rows.front(), segment, sum);
    if (row.queries > 0) carried.push_back(std::move(row));
  }
  return carried;
}

}  // namespace maploc
