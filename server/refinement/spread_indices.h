// At most `most` of `count` indices, evenly spread: pairs of all features would cost their number
// squared.
#pragma once

#include <cstddef>
#include <vector>

namespace maploc {

// Wrong matches whose landmarks are looked at, and features that each is compared with. Of the
// latter as good as all: AgreeingByRepetition must see a landmark's own feature.
inline constexpr std::size_t kMostLandmarks = 64;
inline constexpr std::size_t kMostFeatures = 1000;
// Wrong matches of which each pair is compared.
inline constexpr std::size_t kMostShifts = 160;

inline std::vector<std::size_t> SpreadIndices(std::size_t count, std::size_t most) {
  std::vector<std::size_t> indices;
  const std::size_t step = (count + most - 1) / most;
  for (std::size_t i = 0; i < count; i += step) indices.push_back(i);
  return indices;
}

}  // namespace maploc
