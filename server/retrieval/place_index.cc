#include "server/retrieval/place_index.h"

#include <algorithm>
#include <tuple>

namespace maploc {
namespace {

// One landmark in one segment. Sorted by id, then segment.
struct Holding {
  LandmarkId id = 0;
  std::int32_t segment = 0;
  std::int32_t landmark = 0;  // index into the segment's ids

  auto Key() const { return std::tie(id, segment); }
};

// Of all segments' rows: those of shared landmarks are more than are taken, but only what is
// written takes memory.
std::size_t BytesAtMost(std::span<const SegmentPlace> segments) {
  std::size_t bytes = 0;
  for (const SegmentPlace& segment : segments) bytes += segment.descriptors.bytes.size();
  return bytes;
}

std::vector<Holding> SortedHoldings(std::span<const SegmentPlace> segments) {
  std::vector<Holding> holdings;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const std::vector<LandmarkId>& ids = segments[s].ids;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      holdings.push_back({ids[i], static_cast<std::int32_t>(s), static_cast<std::int32_t>(i)});
    }
  }
  std::sort(holdings.begin(), holdings.end(),
            [](const Holding& a, const Holding& b) { return a.Key() < b.Key(); });
  return holdings;
}

}  // namespace

PlaceIndex PlaceIndex::Build(std::span<const SegmentPlace> segments) {
  PlaceIndex index;
  index.segment_rows_.resize(segments.size());
  index.descriptors_.bytes.reserve(BytesAtMost(segments));  // to grow would copy them twice
  const std::vector<Holding> holdings = SortedHoldings(segments);
  for (std::size_t i = 0; i < holdings.size();) {
    const Holding* richest = nullptr;
    std::int32_t most = 0;
    const LandmarkId id = holdings[i].id;
    index.ids_.push_back(id);
    for (; i < holdings.size() && holdings[i].id == id; ++i) {
      const Holding& holding = holdings[i];
      index.holders_.push_back(holding.segment);
      const std::int32_t rows = segments[holding.segment].row_counts[holding.landmark];
      if (richest != nullptr && rows <= most) continue;
      richest = &holding;
      most = rows;
    }
    index.AddRows(segments[richest->segment], richest->landmark);
    index.segment_begin_.push_back(static_cast<std::int32_t>(index.holders_.size()));
  }
  for (const SegmentPlace& segment : segments) {
    index.reach_.push_back(segment.reach);
    index.paths_.push_back(segment.path_in_map);
  }
  return index;
}

// Rows of the landmark whose holders were added last.
void PlaceIndex::AddRows(const SegmentPlace& segment, std::int32_t landmark) {
  const std::vector<std::int32_t>& owners = segment.descriptor_landmark;
  // A place lists its rows by ascending landmark.
  const auto [first, last] = std::equal_range(owners.begin(), owners.end(), landmark);
  if (first != last) descriptors_.kind = segment.descriptors.kind;
  const std::span<const std::int32_t> holders = std::span(holders_).subspan(segment_begin_.back());
  for (auto row = first; row != last; ++row) {
    const auto bytes = segment.descriptors.row(static_cast<int>(row - owners.begin()));
    const auto index = static_cast<std::int32_t>(row_landmark_.size());
    for (const std::int32_t holder : holders) segment_rows_[holder].push_back(index);
    descriptors_.bytes.insert(descriptors_.bytes.end(), bytes.begin(), bytes.end());
    // The index of the landmark itself: it is counted only when Build closes it in segment_begin_.
    row_landmark_.push_back(landmark_count());
  }
}

std::span<const std::int32_t> PlaceIndex::SegmentsOf(std::int32_t landmark) const {
  const std::span<const std::int32_t> all(holders_);
  const std::int32_t begin = segment_begin_[landmark];
  return all.subspan(begin, segment_begin_[landmark + 1] - begin);
}

}  // namespace maploc
