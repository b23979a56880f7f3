// Shared by point_chance.cc and line_chance.cc: which pairs of wrong matches are compared, and what
// is concluded. Points and lines each have their own comparison.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "server/trust/chance.h"

namespace maploc {

// Largest numbers of wrong matches whose landmarks are used, and of features that each is compared
// with. The latter includes nearly all features: AgreeingByRepetition must see a landmark's own
// feature.
inline constexpr std::size_t kMostLandmarks = 64;
inline constexpr std::size_t kMostFeatures = 1000;
// Largest number of wrong matches that are compared pairwise.
inline constexpr std::size_t kMostShifts = 160;
// Equal displacements in the map differ in the image by about this share (perspective).
inline constexpr double kPerspectiveShare = 0.05;
// Outliers below this distance come from the pose's own noise and from badly triangulated
// landmarks, and therefore resemble each other. Patterns repeat at larger steps.
inline constexpr double kNearMissThresholds = 4.0;

// Result of comparing a pair of matches. Two matches seen in one place show one thing, not a
// pattern: they give kNothing.
enum class PairTells { kNothing, kDifference, kAgreement };

inline PairTells Tell(bool is_pair, bool agree) {
  if (!is_pair) return PairTells::kNothing;
  return agree ? PairTells::kAgreement : PairTells::kDifference;
}

inline void Count(PairTells tells, PairCount& count) {
  count.pairs += tells != PairTells::kNothing ? 1 : 0;
  count.agreeing += tells == PairTells::kAgreement ? 1 : 0;
}

// At most `most` of `count` indices, evenly spread: pairs of all features would cost their number
// squared.
inline std::vector<std::size_t> SpreadIndices(std::size_t count, std::size_t most) {
  std::vector<std::size_t> indices;
  const std::size_t step = (count + most - 1) / most;
  for (std::size_t i = 0; i < count; i += step) indices.push_back(i);
  return indices;
}

// Of `features` features, those that agree with the landmarks of `outliers` (indices of matches; an
// inlier's place is taken by its own feature). `compare(i, j)`: PairTells of feature i and
// landmark j.
template <typename Compare>
PairCount CountWrongPairs(std::size_t features, const std::vector<std::size_t>& outliers,
                          const Compare& compare) {
  const std::vector<std::size_t> looked_at = SpreadIndices(features, kMostFeatures);
  PairCount count;
  std::vector<std::int64_t> per_landmark;
  for (const std::size_t index : SpreadIndices(outliers.size(), kMostLandmarks)) {
    PairCount of_landmark;
    for (const std::size_t i : looked_at) Count(compare(i, outliers[index]), of_landmark);
    count.pairs += of_landmark.pairs;
    per_landmark.push_back(of_landmark.agreeing);
  }
  count.agreeing = AgreeingByRepetition(per_landmark);
  return count;
}

// Whether a wrong match is displaced too far for a near miss; and how much two equal displacements
// may differ.
inline bool IsShifted(double shift, double threshold) {
  return !(shift < kNearMissThresholds * threshold);
}
inline double ShiftTolerance(double shift, double threshold) {
  return std::max(std::numbers::sqrt2 * threshold, kPerspectiveShare * shift);
}

// The share of pairs of shifted outliers with the same displacement, if it is more than accident;
// else 0. `compare(one, other)`: PairTells. `accident(tolerance)`: probability that two agree by
// accident. An Outlier has a `tolerance`.
template <typename Outlier, typename Compare, typename Accident>
double ShareOffAlike(const std::vector<Outlier>& outliers, const Compare& compare,
                     const Accident& accident) {
  const std::vector<std::size_t> looked_at = SpreadIndices(outliers.size(), kMostShifts);
  PairCount count;
  double expected = 0.0;  // pairs alike by accident
  for (std::size_t a = 0; a < looked_at.size(); ++a) {
    const Outlier& one = outliers[looked_at[a]];
    PairCount of_one;
    for (std::size_t b = a + 1; b < looked_at.size(); ++b) {
      Count(compare(one, outliers[looked_at[b]]), of_one);
    }
    count.pairs += of_one.pairs;
    count.agreeing += of_one.agreeing;
    expected += static_cast<double>(of_one.pairs) * std::min(1.0, accident(one.tolerance));
  }
  if (count.pairs == 0) return 0.0;
  const double by_accident = expected / static_cast<double>(count.pairs);
  const double share = ShareBeyondAccident(count, by_accident);
  return share > by_accident ? share : 0.0;
}

}  // namespace maploc
