#include "client/robot/strongest.h"

#include <algorithm>
#include <numeric>

namespace maploc {
namespace {

// Ascending indices of the keypoints to keep.
std::vector<std::size_t> Kept(std::size_t count, const std::vector<float>& scales_px,
                              std::size_t keep) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (scales_px.empty()) {
    // Without scales nothing says which is strong, and the first ones may all be of one corner.
    for (std::size_t i = 0; i < keep; ++i) order[i] = i * count / keep;
  } else {
    // Stable, so that equal scales give the same query in every run.
    std::ranges::stable_sort(
        order, [&](std::size_t a, std::size_t b) { return scales_px[a] > scales_px[b]; });
  }
  order.resize(keep);
  std::ranges::sort(order);
  return order;
}

}  // namespace

PointFeatures Strongest(PointFeatures points, const std::vector<float>& scales_px,
                        int max_features) {
  const std::size_t count = points.keypoints_px.size();
  const auto keep = static_cast<std::size_t>(max_features);
  if (count <= keep) return points;
  const auto bytes = static_cast<std::ptrdiff_t>(points.descriptors.kind.bytes);
  PointFeatures kept;
  kept.descriptors.kind = points.descriptors.kind;
  for (const std::size_t i : Kept(count, scales_px, keep)) {
    kept.keypoints_px.push_back(points.keypoints_px[i]);
    const auto row = points.descriptors.bytes.begin() + static_cast<std::ptrdiff_t>(i) * bytes;
    kept.descriptors.bytes.insert(kept.descriptors.bytes.end(), row, row + bytes);
  }
  return kept;
}

}  // namespace maploc
