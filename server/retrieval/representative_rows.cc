#include "server/retrieval/representative_rows.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

namespace maploc {
namespace {

// Bounds the cost, which grows with the square of the rows.
constexpr int kMaxRowsLookedAt = 16;

double Distance(const Descriptors& descriptors, int a, int b) {
  const std::span<const std::uint8_t> left = descriptors.row(a), right = descriptors.row(b);
  std::uint32_t sum = 0;
  if (descriptors.kind.metric == DescriptorMetric::kHamming) {
    for (std::size_t i = 0; i < left.size(); ++i) {
      sum += std::popcount(static_cast<unsigned>(left[i] ^ right[i]));
    }
    return sum;
  }
  for (std::size_t i = 0; i < left.size(); ++i) {
    const int difference = left[i] - right[i];
    sum += difference * difference;
  }
  return std::sqrt(static_cast<double>(sum));
}

// Distances between the rows that are looked at.
class RowDistances {
 public:
  RowDistances(const Descriptors& descriptors, const std::vector<int>& rows) {
    for (std::size_t a = 0; a < rows.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        distance_[a][b] = distance_[b][a] = Distance(descriptors, rows[a], rows[b]);
      }
    }
  }
  double operator()(int a, int b) const { return distance_[a][b]; }

 private:
  std::array<std::array<double, kMaxRowsLookedAt>, kMaxRowsLookedAt> distance_{};
};

std::vector<int> EvenRows(int begin, int end) {
  const int count = std::min(end - begin, kMaxRowsLookedAt);
  std::vector<int> rows(count);
  for (int i = 0; i < count; ++i) rows[i] = begin + i * (end - begin) / count;
  return rows;
}

}  // namespace

std::vector<int> RepresentativeRows(const Descriptors& descriptors, int begin, int end) {
  const std::vector<int> rows = EvenRows(begin, end);
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
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());  // of equal rows
  return chosen;
}

}  // namespace maploc
