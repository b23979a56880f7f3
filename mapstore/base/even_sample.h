// A part of a list that is spread over its whole length: features and photos are often sorted by
// strength, place or time, and a stride keeps the mixture.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace maploc {

// min(count, max) indices in [0, count), ascending, evenly spread. REQUIRES: both >= 0.
inline std::vector<int> EvenSample(int count, int max) {
  std::vector<int> indices(std::min(count, max));
  for (std::int64_t i = 0; i < std::ssize(indices); ++i) {
    indices[i] = static_cast<int>(i * count / std::ssize(indices));
  }
  return indices;
}

}  // namespace maploc
