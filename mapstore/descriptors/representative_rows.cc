#include "mapstore/descriptors/representative_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "mapstore/base/even_sample.h"
#include "mapstore/descriptors/knn.h"

namespace maploc {
namespace {

// Bounds the cost, which grows with the square of the rows.
constexpr int kMaxRowsLookedAt = 16;

// Distances between the rows that are looked at.
class RowDistances {
 public:
  RowDistances(const Descriptors& descriptors, const std::vector<int>& rows) {
    for (std::size_t a = 0; a < rows.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const std::uint32_t distance = DescriptorDistance(
            descriptors.kind.metric, descriptors.row(rows[a]), descriptors.row(rows[b]));
        distance_[a][b] = distance_[b][a] =
            descriptors.kind.metric == DescriptorMetric::kHamming ? distance : std::sqrt(distance);
      }
    }
  }
  double operator()(int a, int b) const { return distance_[a][b]; }

 private:
  std::array<std::array<double, kMaxRowsLookedAt>, kMaxRowsLookedAt> distance_{};
};

}  // namespace

std::vector<int> RepresentativeRows(const Descriptors& descriptors, int begin, int end) {
  std::vector<int> rows = EvenSample(end - begin, kMaxRowsLookedAt);
  for (int& row : rows) row += begin;
  const int count = static_cast<int>(rows.size());
  if (count <= kRepresentativeRows) return rows;
  const RowDistances distance(descriptors, rows);
  std::vector<double> to_chosen(count, std::numeric_limits<double>::max());
  const auto cost = [&](int candidate) {
    double sum = 0.0;
    for (int row = 0; row < count; ++row) sum += std::min(to_chosen[row], distance(candidate, row));
    return sum;
  };
  std::vector<int> chosen;
  for (int k = 0; k < kRepresentativeRows; ++k) {
    int best = 0;
    for (int candidate = 1; candidate < count; ++candidate) {
      if (cost(candidate) < cost(best)) best = candidate;
    }
    chosen.push_back(rows[best]);
    for (int row = 0; row < count; ++row) {
      to_chosen[row] = std::min(to_chosen[row], distance(best, row));
    }
  }
  std::sort(chosen.begin(), chosen.end());
  // If all rows are equal, the second choice is the first one again.
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

}  // namespace maploc
