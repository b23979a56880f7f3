#include "mapstore/descriptors/knn.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <hwy/aligned_allocator.h>

#include "mapstore/descriptors/distance_kernels.h"
#include "mapstore/descriptors/keep_nearest.h"
#include "mapstore/descriptors/pair_distance.h"

namespace maploc {
namespace {

using kernels::kBlockQueries;
using kernels::kChunkRows;

// A tile stays in the nearest caches while all queries pass over it, and is large enough for the
// calls a tile to cost nothing. (Counted in the largest layout: most tiles take half or less.)
constexpr std::size_t kTileBytes = 64 * 1024;

int TileRows(int row_bytes) {
  const std::size_t rows = kTileBytes / kernels::PackedBytes(row_bytes) / kChunkRows * kChunkRows;
  return static_cast<int>(std::clamp<std::size_t>(rows, 4 * kChunkRows, 32 * kChunkRows));
}

// Buffers of one search, aligned for any vector.
struct Workspace {
  Workspace(int blocks, int tile_rows, int row_bytes)
      : block_bytes(kBlockQueries * kernels::PackedBytes(row_bytes)),
        queries(hwy::AllocateAligned<std::uint8_t>(blocks * block_bytes)),
        query_constants(hwy::AllocateAligned<std::int32_t>(blocks * kBlockQueries)),
        tile(hwy::AllocateAligned<std::uint8_t>(tile_rows * kernels::PackedBytes(row_bytes))),
        row_constants(hwy::AllocateAligned<std::int32_t>(tile_rows)),
        distances(hwy::AllocateAligned<std::uint32_t>(kBlockQueries * tile_rows)) {}

  std::size_t block_bytes;
  hwy::AlignedFreeUniquePtr<std::uint8_t[]> queries;
  hwy::AlignedFreeUniquePtr<std::int32_t[]> query_constants;
  hwy::AlignedFreeUniquePtr<std::uint8_t[]> tile;
  hwy::AlignedFreeUniquePtr<std::int32_t[]> row_constants;
  hwy::AlignedFreeUniquePtr<std::uint32_t[]> distances;
};

void PackAllQueries(const Descriptors& queries, int blocks, Workspace& workspace) {
  const DescriptorKind& kind = queries.kind;
  for (int b = 0; b < blocks; ++b) {
    const int first = b * kBlockQueries;
    kernels::PackQueries(kind.metric, queries.row(first).data(),
                         std::min(kBlockQueries, queries.size() - first), kind.bytes,
                         workspace.queries.get() + b * workspace.block_bytes,
                         workspace.query_constants.get() + first);
  }
}

// All queries against the rows of the packed tile.
void SearchTile(const DescriptorKind& kind, std::span<const std::int32_t> landmarks, int tile_rows,
                Workspace& workspace, std::span<Neighbours> nearest) {
  const int query_count = static_cast<int>(nearest.size());
  for (int first = 0; first < query_count; first += kBlockQueries) {
    kernels::ComputeDistances(
        kind.metric, kind.bytes,
        workspace.queries.get() + first / kBlockQueries * workspace.block_bytes,
        workspace.query_constants.get() + first, workspace.tile.get(),
        workspace.row_constants.get(), static_cast<int>(landmarks.size()), tile_rows,
        workspace.distances.get());
    for (int q = 0; q < std::min(kBlockQueries, query_count - first); ++q) {
      kernels::KeepNearest(workspace.distances.get() + static_cast<std::size_t>(q) * tile_rows,
                           landmarks.data(), static_cast<int>(landmarks.size()),
                           nearest[first + q]);
    }
  }
}

std::vector<FeatureMatch> RatioMatches(std::span<const Neighbours> neighbours,
                                       DescriptorMetric metric, const MatchOptions& options) {
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (!PassesRatio(neighbours[i], metric, options.max_ratio)) continue;
    matches.push_back({static_cast<std::int32_t>(i), neighbours[i].best,
                       static_cast<float>(RatioOf(neighbours[i], metric))});
  }
  return matches;
}

// The landmarks that `matches` name, ascending, each once.
std::vector<std::int32_t> MatchedLandmarks(const std::vector<FeatureMatch>& matches) {
  std::vector<std::int32_t> landmarks;
  landmarks.reserve(matches.size());
  for (const FeatureMatch& match : matches) landmarks.push_back(match.landmark);
  std::sort(landmarks.begin(), landmarks.end());
  landmarks.erase(std::unique(landmarks.begin(), landmarks.end()), landmarks.end());
  return landmarks;
}

struct NearestQuery {
  std::int32_t query = -1;
  std::uint32_t distance = 0;
};

// For each of `landmarks` (ascending): the query nearest to any of its rows, the lower on a tie.
std::vector<NearestQuery> NearestQueries(const std::vector<std::int32_t>& landmarks,
                                         const Descriptors& queries, const Descriptors& database,
                                         std::span<const std::int32_t> row_landmark) {
  Descriptors rows{database.kind, {}};
  std::vector<std::int32_t> owner;  // of each gathered row: index into `landmarks`
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const auto [first, last] =
        std::equal_range(row_landmark.begin(), row_landmark.end(), landmarks[i]);
    for (auto row = first; row != last; ++row) {
      const auto bytes = database.row(static_cast<int>(row - row_landmark.begin()));
      rows.bytes.insert(rows.bytes.end(), bytes.begin(), bytes.end());
      owner.push_back(static_cast<std::int32_t>(i));
    }
  }
  // In the search back the queries are the database, and each is a landmark of its own.
  std::vector<std::int32_t> itself(queries.size());
  for (std::size_t i = 0; i < itself.size(); ++i) itself[i] = static_cast<std::int32_t>(i);
  const std::vector<Neighbours> nearest = FindNeighbours(rows, queries, itself);
  std::vector<NearestQuery> result(landmarks.size());
  for (std::size_t row = 0; row < nearest.size(); ++row) {
    NearestQuery& known = result[owner[row]];
    const NearestQuery found{nearest[row].best, nearest[row].best_distance};
    const bool nearer = found.distance < known.distance ||
                        (found.distance == known.distance && found.query < known.query);
    if (known.query < 0 || nearer) known = found;
  }
  return result;
}

// Erases the matches whose landmark has a nearer query than theirs. The way back is asked only for
// landmarks that a match names: a small part of the database.
void EraseOneWay(const Descriptors& queries, const Descriptors& database,
                 std::span<const std::int32_t> row_landmark, std::vector<FeatureMatch>& matches) {
  const std::vector<std::int32_t> landmarks = MatchedLandmarks(matches);
  const std::vector<NearestQuery> nearest =
      NearestQueries(landmarks, queries, database, row_landmark);
  std::erase_if(matches, [&](const FeatureMatch& match) {
    const auto at = std::lower_bound(landmarks.begin(), landmarks.end(), match.landmark);
    return nearest[at - landmarks.begin()].query != match.feature;
  });
}

}  // namespace

std::vector<Neighbours> FindNeighbours(const Descriptors& queries, const Descriptors& database,
                                       std::span<const std::int32_t> row_landmark) {
  assert(queries.kind == database.kind || queries.size() == 0 || database.size() == 0);
  assert(row_landmark.size() == static_cast<std::size_t>(database.size()));
  if (queries.size() == 0 || database.size() == 0) {
    return std::vector<Neighbours>(queries.size());
  }
  const DescriptorKind& kind = database.kind;
  const int tile_rows = TileRows(kind.bytes);
  const int blocks = (queries.size() + kBlockQueries - 1) / kBlockQueries;
  Workspace workspace(blocks, tile_rows, kind.bytes);
  PackAllQueries(queries, blocks, workspace);
  std::vector<Neighbours> nearest(queries.size());
  for (int first = 0; first < database.size(); first += tile_rows) {
    const int rows = std::min(tile_rows, database.size() - first);
    kernels::PackRows(kind.metric, database.row(first).data(), rows, kind.bytes,
                      workspace.tile.get(), workspace.row_constants.get());
    SearchTile(kind, row_landmark.subspan(first, rows), tile_rows, workspace, nearest);
  }
  return nearest;
}

double RatioOf(const Neighbours& n, DescriptorMetric metric) {
  if (n.second_distance == UINT32_MAX || n.second_distance == 0) return 1.0;
  const double ratio = static_cast<double>(n.best_distance) / n.second_distance;
  // L2 distances are squared here, but the ratio is one of distances.
  return metric == DescriptorMetric::kL2U8 ? std::sqrt(ratio) : ratio;
}

bool PassesRatio(const Neighbours& n, DescriptorMetric metric, float max_ratio) {
  if (n.best < 0) return false;
  const bool alone = n.second_distance == UINT32_MAX;
  return alone || RatioOf(n, metric) <= static_cast<double>(max_ratio);
}

std::vector<FeatureMatch> MatchDescriptors(const Descriptors& queries, const Descriptors& database,
                                           std::span<const std::int32_t> row_landmark,
                                           const MatchOptions& options) {
  return MatchNeighbours(FindNeighbours(queries, database, row_landmark), queries, database,
                         row_landmark, options);
}

std::vector<FeatureMatch> MatchNeighbours(std::span<const Neighbours> neighbours,
                                          const Descriptors& queries, const Descriptors& database,
                                          std::span<const std::int32_t> row_landmark,
                                          const MatchOptions& options) {
  std::vector<FeatureMatch> matches = RatioMatches(neighbours, database.kind.metric, options);
  if (options.mutual) EraseOneWay(queries, database, row_landmark, matches);
  return matches;
}

std::vector<FeatureMatch> MatchSome(const Descriptors& queries, std::span<const std::int32_t> asked,
                                    const Descriptors& database,
                                    std::span<const std::int32_t> row_landmark,
                                    const MatchOptions& options) {
  const std::vector<Neighbours> neighbours =
      FindNeighbours(GatherRows(queries, asked), database, row_landmark);
  std::vector<FeatureMatch> matches = RatioMatches(neighbours, database.kind.metric, options);
  for (FeatureMatch& match : matches) match.feature = asked[match.feature];
  if (options.mutual) EraseOneWay(queries, database, row_landmark, matches);
  return matches;
}

std::uint32_t DescriptorDistance(DescriptorMetric metric, std::span<const std::uint8_t> a,
                                 std::span<const std::uint8_t> b) {
  assert(a.size() == b.size());
  return kernels::Distance(metric, static_cast<int>(a.size()), a.data(), b.data());
}

}  // namespace maploc
