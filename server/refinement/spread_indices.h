// At most kMaxPairSide of `count` indices, evenly spread: pairs of all features would cost a
// quarter of their number squared.
#pragma once

#include <cstddef>
#include <vector>

namespace maploc {

inline constexpr std::size_t kMaxPairSide = 160;

inline std::vector<std::size_t> SpreadIndices(std::size_t count) {
  std::vector<std::size_t> indices;
  const std::size_t step = (count + kMaxPairSide - 1) / kMaxPairSide;
  for (std::size_t i = 0; i < count; i += step) indices.push_back(i);
  return indices;
}

}  // namespace maploc
