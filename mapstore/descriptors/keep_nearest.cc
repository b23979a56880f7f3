#include "mapstore/descriptors/keep_nearest.h"

#include <algorithm>
#include <bit>

#include "mapstore/descriptors/distance_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mapstore/descriptors/keep_nearest.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace maploc::kernels {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Smallest of `count` distances. REQUIRES: a positive multiple of the lanes, aligned.
template <typename D>
HWY_INLINE std::uint32_t Smallest(D d, const std::uint32_t* distances, int count) {
  auto smallest = hn::Load(d, distances);
  for (int i = static_cast<int>(hn::Lanes(d)); i < count; i += static_cast<int>(hn::Lanes(d))) {
    smallest = hn::Min(smallest, hn::Load(d, distances + i));
  }
  return hn::GetLane(hn::MinOfLanes(d, smallest));
}

// A distance that two landmarks do not exceed: one in the first third of the rows, one in the last.
// (A landmark's rows stand together, so that it is in both only if it fills the middle third.)
template <typename D>
HWY_INLINE std::uint32_t ReachedByTwo(D d, const std::uint32_t* distances,
                                      const std::int32_t* landmarks, int count) {
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int third = count / 3 / lanes * lanes;
  const int last = (count - third) / lanes * lanes;
  if (third == 0 || landmarks[third - 1] == landmarks[last]) return UINT32_MAX;
  return std::max(Smallest(d, distances, third), Smallest(d, distances + last, third));
}

// Few rows pass the bound. It only falls, so a row is compared with the newest second distance once
// more when its turn comes. While a query has no neighbour, most of its first rows would be
// inserted and soon replaced; so the bound begins with a distance that two landmarks reach.
void KeepNearest(const std::uint32_t* distances, const std::int32_t* landmarks, int count,
                 Neighbours& nearest) {
  const hn::CappedTag<std::uint32_t, kChunkRows> d;
  std::uint32_t reached = UINT32_MAX;
  if (nearest.best < 0) reached = ReachedByTwo(d, distances, landmarks, count);
  // The comparison is strict, and rows at the reached distance itself must pass.
  const std::uint32_t beyond = reached == UINT32_MAX ? reached : reached + 1;
  auto bound = hn::Set(d, std::min(beyond, nearest.second_distance));
  for (int first = 0; first < count; first += static_cast<int>(hn::Lanes(d))) {
    const auto below = hn::Lt(hn::Load(d, distances + first), bound);
    if (hn::AllFalse(d, below)) continue;
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, below, bytes);
    // There are at most kChunkRows = 16 lanes, so two bytes hold the mask.
    for (unsigned bits = bytes[0] | bytes[1] << 8; bits != 0; bits &= bits - 1) {
      const int row = first + std::countr_zero(bits);
      // Rows of padding have no landmark.
      if (row >= count) break;
      if (distances[row] < nearest.second_distance) nearest.Insert(landmarks[row], distances[row]);
    }
    bound = hn::Set(d, std::min(beyond, nearest.second_distance));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace maploc::kernels
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace maploc::kernels {

HWY_EXPORT(KeepNearest);

void KeepNearest(const std::uint32_t* distances, const std::int32_t* landmarks, int count,
                 Neighbours& nearest) {
  HWY_DYNAMIC_DISPATCH(KeepNearest)(distances, landmarks, count, nearest);
}

}  // namespace maploc::kernels
#endif  // HWY_ONCE
