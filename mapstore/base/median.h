// Medians of values that the caller gives away, and what they say of normal values. Pure functions,
// linear in their number.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <vector>

namespace maploc {

// Standard deviation of normal values, as a multiple of their median absolute deviation.
inline constexpr double kSigmaOfMad = 1.4826;
// Variance of the median of n normal values, times n, as a multiple of the variance of one.
inline constexpr double kMedianVariance = std::numbers::pi / 2.0;

// Of an even count the higher one of the middle two: always one of the values. REQUIRES: not empty.
template <typename T>
T UpperMedian(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Of an even count the mean of the middle two, which favours neither small values nor large ones.
// REQUIRES: not empty.
template <typename T>
double Median(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const auto upper = static_cast<double>(*middle);
  if (values.size() % 2 == 1) return upper;
  return 0.5 * (upper + static_cast<double>(*std::max_element(values.begin(), middle)));
}

}  // namespace maploc
