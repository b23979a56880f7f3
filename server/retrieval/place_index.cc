#include "server/retrieval/place_index.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "mapstore/base/median.h"
#include "server/retrieval/path_distance.h"
#include "server/retrieval/representative_rows.h"

namespace maploc {
namespace {

// Landmarks enough for a median, whatever the segment's size.
constexpr int kReachSamples = 256;

double MedianReach(const Segment& segment) {
  const std::vector<Eigen::Vector3d>& positions = segment.points.positions_in_map;
  if (positions.empty() || segment.path_in_map.empty()) return 0.0;
  const std::size_t step = 1 + (positions.size() - 1) / kReachSamples;
  std::vector<double> distances;
  for (std::size_t i = 0; i < positions.size(); i += step) {
    distances.push_back(DistanceToPath(positions[i], segment.path_in_map));
  }
  return UpperMedian(std::move(distances));
}

struct RowRange {
  std::int32_t begin = 0;
  std::int32_t end = 0;
  std::int32_t size() const { return end - begin; }
};

RowRange RowsOfLandmark(const PointLandmarks& points, std::int32_t landmark) {
  const auto& owners = points.descriptor_landmark;
  const auto [first, last] = std::equal_range(owners.begin(), owners.end(), landmark);
  return {static_cast<std::int32_t>(first - owners.begin()),
          static_cast<std::int32_t>(last - owners.begin())};
}

// One landmark in one segment. Sorted by id, then segment.
struct Holding {
  LandmarkId id = 0;
  std::int32_t segment = 0;
  std::int32_t landmark = 0;  // index into the segment's points

  auto Key() const { return std::tie(id, segment); }
};

std::vector<Holding> SortedHoldings(std::span<const std::shared_ptr<const Segment>> segments) {
  std::vector<Holding> holdings;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const std::vector<LandmarkId>& ids = segments[s]->points.ids;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      holdings.push_back({ids[i], static_cast<std::int32_t>(s), static_cast<std::int32_t>(i)});
    }
  }
  std::sort(holdings.begin(), holdings.end(),
            [](const Holding& a, const Holding& b) { return a.Key() < b.Key(); });
  return holdings;
}

}  // namespace

PlaceIndex PlaceIndex::Build(std::span<const std::shared_ptr<const Segment>> segments) {
  PlaceIndex index;
  index.segment_rows_.resize(segments.size());
  const std::vector<Holding> holdings = SortedHoldings(segments);
  for (std::size_t i = 0; i < holdings.size();) {
    const PointLandmarks* richest = nullptr;
    RowRange rows;
    const LandmarkId id = holdings[i].id;
    index.ids_.push_back(id);
    for (; i < holdings.size() && holdings[i].id == id; ++i) {
      index.holders_.push_back(holdings[i].segment);
      const PointLandmarks& points = segments[holdings[i].segment]->points;
      const RowRange found = RowsOfLandmark(points, holdings[i].landmark);
      if (richest == nullptr || found.size() > rows.size()) {
        richest = &points;
        rows = found;
      }
    }
    index.AddRows(richest->descriptors,
                  RepresentativeRows(richest->descriptors, rows.begin, rows.end));
    index.segment_begin_.push_back(static_cast<std::int32_t>(index.holders_.size()));
  }
  for (const auto& segment : segments) {
    index.reach_.push_back(MedianReach(*segment));
    index.paths_.push_back(segment->path_in_map);
  }
  return index;
}

// Rows of the landmark whose holders were added last.
void PlaceIndex::AddRows(const Descriptors& descriptors, const std::vector<int>& rows) {
  if (!rows.empty()) descriptors_.kind = descriptors.kind;
  const std::span<const std::int32_t> holders = std::span(holders_).subspan(segment_begin_.back());
  for (const int row : rows) {
    const auto bytes = descriptors.row(row);
    for (const std::int32_t segment : holders)
      segment_rows_[segment].push_back(descriptors_.size());
    descriptors_.bytes.insert(descriptors_.bytes.end(), bytes.begin(), bytes.end());
    row_landmark_.push_back(landmark_count());
  }
}

std::span<const std::int32_t> PlaceIndex::SegmentsOf(std::int32_t landmark) const {
  const std::span<const std::int32_t> all(holders_);
  const std::int32_t begin = segment_begin_[landmark];
  return all.subspan(begin, segment_begin_[landmark + 1] - begin);
}

}  // namespace maploc
