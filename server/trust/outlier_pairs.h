// What chance.cc and line_chance.cc share: which pairs of wrong matches are looked at, and what
// they tell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/trust/chance.h"

namespace maploc {

// Wrong matches whose landmarks are looked at, and features that each is compared with. Of the
// latter as good as all: AgreeingByRepetition must see a landmark's own feature.
inline constexpr std::size_t kMostLandmarks = 64;
inline constexpr std::size_t kMostFeatures = 1000;
// Wrong matches of which each pair is compared.
inline constexpr std::size_t kMostShifts = 160;
// Displacements by the same distance in the map differ in the image by about this share.
inline constexpr double kPerspectiveShare = 0.05;
// Outliers that lie this close are the tail of the same pose's noise and of badly triangulated
// landmarks, and all alike in that; a pattern repeats at larger steps.
inline constexpr double kNearMissThresholds = 4.0;

// At most `most` of `count` indices, evenly spread: pairs of all features would cost their number
// squared.
inline std::vector<std::size_t> SpreadIndices(std::size_t count, std::size_t most) {
  std::vector<std::size_t> indices;
  const std::size_t step = (count + most - 1) / most;
  for (std::size_t i = 0; i < count; i += step) indices.push_back(i);
  return indices;
}

// The share of pairs that are off alike where it is more than accident, of which `expected` pairs
// are; else 0.
inline double ShareOfPattern(const PairCount& count, double expected) {
  if (count.pairs == 0) return 0.0;
  const double accident = expected / static_cast<double>(count.pairs);
  const double share = ShareBeyondAccident(count, accident);
  return share > accident ? share : 0.0;
}

}  // namespace maploc
