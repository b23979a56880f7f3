#include "mapstore/descriptors/pair_distance.h"

#include <bit>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mapstore/descriptors/pair_distance.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace maploc::kernels {
namespace HWY_NAMESPACE {

std::uint32_t HammingDistance(int row_bytes, const std::uint8_t* a, const std::uint8_t* b) {
  std::uint32_t sum = 0;
  int byte = 0;
  for (; byte + 8 <= row_bytes; byte += 8) {
    std::uint64_t left, right;
    // A row need not be aligned to 8 bytes.
    std::memcpy(&left, a + byte, 8);
    std::memcpy(&right, b + byte, 8);
    sum += std::popcount(left ^ right);
  }
  for (; byte < row_bytes; ++byte) sum += std::popcount(static_cast<unsigned>(a[byte] ^ b[byte]));
  return sum;
}

std::uint32_t SquaredL2Distance(int row_bytes, const std::uint8_t* a, const std::uint8_t* b) {
  std::uint32_t sum = 0;
  for (int byte = 0; byte < row_bytes; ++byte) {
    const int difference = a[byte] - b[byte];
    sum += static_cast<std::uint32_t>(difference * difference);
  }
  return sum;
}

std::uint32_t Distance(DescriptorMetric metric, int row_bytes, const std::uint8_t* a,
                       const std::uint8_t* b) {
  return metric == DescriptorMetric::kHamming ? HammingDistance(row_bytes, a, b)
                                              : SquaredL2Distance(row_bytes, a, b);
}

}  // namespace HWY_NAMESPACE
}  // namespace maploc::kernels
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace maploc::kernels {

HWY_EXPORT(Distance);

std::uint32_t Distance(DescriptorMetric metric, int row_bytes, const std::uint8_t* a,
                       const std::uint8_t* b) {
  return HWY_DYNAMIC_DISPATCH(Distance)(metric, row_bytes, a, b);
}

}  // namespace maploc::kernels
#endif  // HWY_ONCE
