// Medians of values that the caller gives away. Pure functions, linear in their number.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace maploc {

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
