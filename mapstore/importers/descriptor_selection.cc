#include "mapstore/importers/descriptor_selection.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace maploc {
namespace {

using Row = const std::uint8_t*;

std::uint64_t Distance(const DescriptorKind& kind, Row a, Row b) {
  std::uint64_t distance = 0;
  for (int i = 0; i < kind.bytes; ++i) {
    if (kind.metric == DescriptorMetric::kHamming) {
      distance += static_cast<std::uint64_t>(std::popcount(static_cast<std::uint8_t>(a[i] ^ b[i])));
    } else {
      const int difference = int{a[i]} - int{b[i]};
      distance += static_cast<std::uint64_t>(difference * difference);
    }
  }
  return distance;
}

std::size_t FindMedoid(const DescriptorKind& kind, const std::vector<Row>& rows) {
  std::vector<std::uint64_t> sums;
  for (const Row a : rows) {
    std::uint64_t sum = 0;
    for (const Row b : rows) sum += Distance(kind, a, b);
    sums.push_back(sum);
  }
  return static_cast<std::size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin());
}

}  // namespace

std::vector<std::uint8_t> SelectDescriptors(const DescriptorKind& kind,
                                            const std::vector<std::uint8_t>& bytes, int max_rows) {
  const auto row_bytes = static_cast<std::size_t>(kind.bytes);
  const std::size_t limit = static_cast<std::size_t>(max_rows);
  if (row_bytes == 0 || bytes.size() <= limit * row_bytes) return bytes;
  std::vector<Row> rows;
  for (std::size_t i = 0; i < bytes.size(); i += row_bytes) rows.push_back(&bytes[i]);
  std::vector<std::size_t> kept = {FindMedoid(kind, rows)};
  std::vector<std::uint64_t> nearest(rows.size(), UINT64_MAX);  // distance to those kept
  while (kept.size() < limit) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      nearest[i] = std::min(nearest[i], Distance(kind, rows[i], rows[kept.back()]));
    }
    const auto farthest = std::max_element(nearest.begin(), nearest.end());
    if (*farthest == 0) break;  // only copies are left
    kept.push_back(static_cast<std::size_t>(farthest - nearest.begin()));
  }
  std::sort(kept.begin(), kept.end());
  std::vector<std::uint8_t> selected;
  for (const std::size_t i : kept) selected.insert(selected.end(), rows[i], rows[i] + row_bytes);
  return selected;
}

}  // namespace maploc
