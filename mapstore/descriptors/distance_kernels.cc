#include "mapstore/descriptors/distance_kernels.h"

#include <bit>
#include <cstring>
#include <span>

// AVX3_DL has vpopcntd and the byte dot product; Highway compiles it only on demand. It includes
// this file again for each instruction set.
#define HWY_WANT_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mapstore/descriptors/distance_kernels.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "mapstore/descriptors/row_sums.h"

HWY_BEFORE_NAMESPACE();
namespace maploc::kernels {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int RoundUp(int value, int multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

// Lays chunks of kChunkRows out as [group][row][group bytes]; bytes beyond the descriptor and rows
// beyond `count` are zeros.
template <typename Element, int kGroup>
void PackTransposed(const std::uint8_t* rows, int count, int row_bytes, Element* tile) {
  const int groups = RoundUp(row_bytes, kGroup) / kGroup;
  const std::size_t chunk_size = static_cast<std::size_t>(groups) * kGroup * kChunkRows;
  std::memset(tile, 0, RoundUp(count, kChunkRows) / kChunkRows * chunk_size * sizeof(Element));
  for (int row = 0; row < count; ++row) {
    const std::uint8_t* from = rows + static_cast<std::size_t>(row) * row_bytes;
    Element* to = tile + row / kChunkRows * chunk_size + row % kChunkRows * kGroup;
    int byte = 0;
    for (; byte + kGroup <= row_bytes; byte += kGroup, to += kGroup * kChunkRows) {
      for (int i = 0; i < kGroup; ++i) to[i] = from[byte + i];
    }
    for (int i = 0; byte + i < row_bytes; ++i) to[i] = from[byte + i];
  }
}

// Queries lie one after the other, each padded to whole groups.
template <typename Element, int kGroup, class Convert>
void PackBlock(const std::uint8_t* queries, int count, int row_bytes, Element* block,
               const Convert& convert) {
  const int padded = RoundUp(row_bytes, kGroup);
  for (int q = 0; q < kBlockQueries; ++q) {
    for (int byte = 0; byte < padded; ++byte) {
      const bool inside = q < count && byte < row_bytes;
      const std::size_t from = static_cast<std::size_t>(q) * row_bytes + byte;
      block[q * padded + byte] = inside ? convert(queries[from]) : Element{0};
    }
  }
}

constexpr auto kSame = [](std::uint8_t byte) { return byte; };

// Hamming distance.

#if HWY_TARGET == HWY_AVX3_DL
// One lane a row, 32 bits at a time.
constexpr int kHammingGroup = 4;

void PackHammingRows(const std::uint8_t* rows, int count, int row_bytes, std::uint8_t* tile) {
  PackTransposed<std::uint8_t, kHammingGroup>(rows, count, row_bytes, tile);
}

void HammingDistances(int row_bytes, const std::uint8_t* block, const std::uint8_t* tile,
                      int row_count, std::size_t row_stride, std::uint32_t* distances) {
  const hn::FixedTag<std::uint32_t, kChunkRows> d;
  const int words = RoundUp(row_bytes, kHammingGroup) / kHammingGroup;
  const auto* query = reinterpret_cast<const std::uint32_t*>(block);
  const auto* chunk = reinterpret_cast<const std::uint32_t*>(tile);
  for (int row = 0; row < row_count; row += kChunkRows) {
    auto sum0 = hn::Zero(d), sum1 = hn::Zero(d), sum2 = hn::Zero(d), sum3 = hn::Zero(d);
    for (int w = 0; w < words; ++w, chunk += kChunkRows) {
      const auto bits = hn::Load(d, chunk);
      sum0 += hn::PopulationCount(bits ^ hn::Set(d, query[w]));
      sum1 += hn::PopulationCount(bits ^ hn::Set(d, query[words + w]));
      sum2 += hn::PopulationCount(bits ^ hn::Set(d, query[2 * words + w]));
      sum3 += hn::PopulationCount(bits ^ hn::Set(d, query[3 * words + w]));
    }
    hn::Store(sum0, d, distances + row);
    hn::Store(sum1, d, distances + row_stride + row);
    hn::Store(sum2, d, distances + 2 * row_stride + row);
    hn::Store(sum3, d, distances + 3 * row_stride + row);
  }
}
#else
// 64 bits at a time through the scalar popcnt, which beats a table in vector registers. Targets
// from SSE4 on have the instruction; below, the compiler's table serves.
constexpr int kHammingGroup = 8;

void PackHammingRows(const std::uint8_t* rows, int count, int row_bytes, std::uint8_t* tile) {
  const std::size_t padded = RoundUp(row_bytes, kHammingGroup);
  std::memset(tile, 0, RoundUp(count, kChunkRows) * padded);
  for (int row = 0; row < count; ++row) {
    std::memcpy(tile + row * padded, rows + static_cast<std::size_t>(row) * row_bytes, row_bytes);
  }
}

void HammingDistances(int row_bytes, const std::uint8_t* block, const std::uint8_t* tile,
                      int row_count, std::size_t row_stride, std::uint32_t* distances) {
  const int words = RoundUp(row_bytes, kHammingGroup) / kHammingGroup;
  const auto* query = reinterpret_cast<const std::uint64_t*>(block);
  const auto* bits = reinterpret_cast<const std::uint64_t*>(tile);
  for (int row = 0; row < row_count; ++row, bits += words) {
    int sum0 = 0, sum1 = 0, sum2 = 0, sum3 = 0;
    for (int w = 0; w < words; ++w) {
      sum0 += std::popcount(bits[w] ^ query[w]);
      sum1 += std::popcount(bits[w] ^ query[words + w]);
      sum2 += std::popcount(bits[w] ^ query[2 * words + w]);
      sum3 += std::popcount(bits[w] ^ query[3 * words + w]);
    }
    distances[row] = sum0;
    distances[row_stride + row] = sum1;
    distances[2 * row_stride + row] = sum2;
    distances[3 * row_stride + row] = sum3;
  }
}
#endif

// Squared L2 distance: |q - d|^2 = |q|^2 + |d|^2 - 2 q.d.

#if HWY_TARGET == HWY_AVX3_DL
// vpdpbusd multiplies unsigned by signed bytes, so q travels as q - 128 and the row's constant
// makes up for it: q.d = (q - 128).d + 128 sum(d).
constexpr int kL2Group = 4;
using L2RowElement = std::uint8_t;
using L2QueryElement = std::int8_t;
constexpr auto kToL2Query = [](std::uint8_t byte) { return static_cast<std::int8_t>(byte - 128); };
constexpr int kL2Chunks = 4;  // accumulators enough to hide the product's latency

// |d|^2 and what -2 q.d has beside -2 (q - 128).d.
std::int32_t L2RowConstant(std::span<const std::uint8_t> row) {
  return SquaredNorm(row) - 256 * Sum(row);
}

// Highway 1.0's AVX3_DL does not name AVX512-VNNI, though every processor with the rest of it has
// it (checked once, below).
#pragma GCC push_options
#pragma GCC target("avx512vnni")

// Inner products of kBlockQueries queries and kChunks chunks.
template <int kChunks>
void L2Chunks(int groups, const std::int32_t* query, const std::int32_t* chunk,
              __m512i query_norm[], const std::int32_t* row_constants, std::size_t row_stride,
              std::uint32_t* distances) {
  __m512i sum[kBlockQueries][kChunks];
  for (auto& sums : sum) {
    for (auto& s : sums) s = _mm512_setzero_si512();
  }
  for (int g = 0; g < groups; ++g) {
    __m512i row[kChunks];
    for (int c = 0; c < kChunks; ++c) {
      row[c] = _mm512_load_si512(chunk + (static_cast<std::size_t>(c) * groups + g) * kChunkRows);
    }
    for (int q = 0; q < kBlockQueries; ++q) {
      const __m512i values = _mm512_set1_epi32(query[q * groups + g]);
      for (int c = 0; c < kChunks; ++c) sum[q][c] = _mm512_dpbusd_epi32(sum[q][c], row[c], values);
    }
  }
  for (int q = 0; q < kBlockQueries; ++q) {
    for (int c = 0; c < kChunks; ++c) {
      const __m512i constant = _mm512_load_si512(row_constants + c * kChunkRows);
      const __m512i squares = _mm512_add_epi32(query_norm[q], constant);
      const __m512i distance = _mm512_sub_epi32(squares, _mm512_slli_epi32(sum[q][c], 1));
      _mm512_store_si512(distances + q * row_stride + c * kChunkRows, distance);
    }
  }
}

void L2Distances(int row_bytes, const std::uint8_t* block, const std::int32_t* block_constants,
                 const std::uint8_t* tile, const std::int32_t* row_constants, int row_count,
                 std::size_t row_stride, std::uint32_t* distances) {
  const int groups = RoundUp(row_bytes, kL2Group) / kL2Group;
  const auto* query = reinterpret_cast<const std::int32_t*>(block);
  const auto* chunk = reinterpret_cast<const std::int32_t*>(tile);
  __m512i norm[kBlockQueries];
  for (int q = 0; q < kBlockQueries; ++q) norm[q] = _mm512_set1_epi32(block_constants[q]);
  int row = 0;
  const auto advance = [&](int chunks) {
    row += chunks * kChunkRows;
    chunk += static_cast<std::size_t>(chunks) * groups * kChunkRows;
  };
  for (; row + kL2Chunks * kChunkRows <= RoundUp(row_count, kChunkRows); advance(kL2Chunks)) {
    L2Chunks<kL2Chunks>(groups, query, chunk, norm, row_constants + row, row_stride,
                        distances + row);
  }
  for (; row < row_count; advance(1)) {
    L2Chunks<1>(groups, query, chunk, norm, row_constants + row, row_stride, distances + row);
  }
}
#pragma GCC pop_options
#else
// Pairs of 16-bit numbers, multiplied and added into the 32-bit lane of their row.
constexpr int kL2Group = 2;
using L2RowElement = std::int16_t;
using L2QueryElement = std::int16_t;
constexpr auto kToL2Query = [](std::uint8_t byte) { return static_cast<std::int16_t>(byte); };

std::int32_t L2RowConstant(std::span<const std::uint8_t> row) { return SquaredNorm(row); }

// sum + a.even * b.even + a.odd * b.odd in each 32-bit lane. Highway 1.0 promises no order of lanes
// (ReorderWidenMulAccumulate); on x86 it is pmaddwd, whose order is the one wanted.
template <class D32, class V32>
HWY_INLINE V32 MultiplyAddPairs(D32 d32, V32 a, V32 b, V32 sum) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
  const hn::Repartition<std::int16_t, D32> d16;
  V32 unused = hn::Zero(d32);
  return hn::ReorderWidenMulAccumulate(d32, hn::BitCast(d16, a), hn::BitCast(d16, b), sum, unused);
#else
  (void)d32;
  const V32 even =
      hn::Mul(hn::ShiftRight<16>(hn::ShiftLeft<16>(a)), hn::ShiftRight<16>(hn::ShiftLeft<16>(b)));
  const V32 odd = hn::Mul(hn::ShiftRight<16>(a), hn::ShiftRight<16>(b));
  return hn::Add(sum, hn::Add(even, odd));
#endif
}

void L2Distances(int row_bytes, const std::uint8_t* block, const std::int32_t* block_constants,
                 const std::uint8_t* tile, const std::int32_t* row_constants, int row_count,
                 std::size_t row_stride, std::uint32_t* distances) {
  // Two vectors of at most half a chunk: 8 accumulators, which AVX2's 16 registers can hold.
  const hn::CappedTag<std::int32_t, kChunkRows / 2> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int groups = RoundUp(row_bytes, kL2Group) / kL2Group;
  const auto* query = reinterpret_cast<const std::int32_t*>(block);
  for (int row = 0; row < row_count; row += 2 * lanes) {
    const auto* chunk = reinterpret_cast<const std::int32_t*>(tile) +
                        static_cast<std::size_t>(row / kChunkRows) * groups * kChunkRows +
                        row % kChunkRows;
    hn::VFromD<decltype(d)> sum[kBlockQueries][2];
    for (auto& sums : sum) sums[0] = sums[1] = hn::Zero(d);
    for (int g = 0; g < groups; ++g, chunk += kChunkRows) {
      const auto low = hn::Load(d, chunk);
      const auto high = hn::Load(d, chunk + lanes);
      for (int q = 0; q < kBlockQueries; ++q) {
        const auto values = hn::Set(d, query[q * groups + g]);
        sum[q][0] = MultiplyAddPairs(d, low, values, sum[q][0]);
        sum[q][1] = MultiplyAddPairs(d, high, values, sum[q][1]);
      }
    }
    for (int q = 0; q < kBlockQueries; ++q) {
      for (int half = 0; half < 2; ++half) {
        const auto squares =
            hn::Load(d, row_constants + row + half * lanes) + hn::Set(d, block_constants[q]);
        const auto distance = squares - hn::ShiftLeft<1>(sum[q][half]);
        hn::Store(hn::BitCast(hn::RebindToUnsigned<decltype(d)>(), distance),
                  hn::RebindToUnsigned<decltype(d)>(),
                  distances + q * row_stride + row + half * lanes);
      }
    }
  }
}
#endif

// The functions that are dispatched.

void PackRows(DescriptorMetric metric, const std::uint8_t* rows, int count, int row_bytes,
              std::uint8_t* tile, std::int32_t* constants) {
  if (metric == DescriptorMetric::kHamming) {
    PackHammingRows(rows, count, row_bytes, tile);
    return;
  }
  PackTransposed<L2RowElement, kL2Group>(rows, count, row_bytes,
                                         reinterpret_cast<L2RowElement*>(tile));
  for (int row = 0; row < RoundUp(count, kChunkRows); ++row) {
    const std::uint8_t* bytes = rows + static_cast<std::size_t>(row) * row_bytes;
    constants[row] = row < count ? L2RowConstant(std::span(bytes, row_bytes)) : 0;
  }
}

void PackQueries(DescriptorMetric metric, const std::uint8_t* queries, int count, int row_bytes,
                 std::uint8_t* block, std::int32_t* constants) {
  if (metric == DescriptorMetric::kHamming) {
    PackBlock<std::uint8_t, kHammingGroup>(queries, count, row_bytes, block, kSame);
    return;
  }
  PackBlock<L2QueryElement, kL2Group>(queries, count, row_bytes,
                                      reinterpret_cast<L2QueryElement*>(block), kToL2Query);
  for (int q = 0; q < kBlockQueries; ++q) {
    const std::uint8_t* bytes = queries + static_cast<std::size_t>(q) * row_bytes;
    constants[q] = q < count ? SquaredNorm(std::span(bytes, row_bytes)) : 0;
  }
}

void ComputeDistances(DescriptorMetric metric, int row_bytes, const std::uint8_t* block,
                      const std::int32_t* block_constants, const std::uint8_t* tile,
                      const std::int32_t* row_constants, int row_count, std::size_t row_stride,
                      std::uint32_t* distances) {
  if (metric == DescriptorMetric::kHamming) {
    HammingDistances(row_bytes, block, tile, row_count, row_stride, distances);
  } else {
    L2Distances(row_bytes, block, block_constants, tile, row_constants, row_count, row_stride,
                distances);
  }
}

const char* KernelTargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace maploc::kernels
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace maploc::kernels {
namespace {

#if HWY_ARCH_X86
// Runs before main, hence before the first dispatch.
[[maybe_unused]] const bool kVnniChecked = [] {
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx512vnni")) hwy::DisableTargets(HWY_AVX3_DL);
  return true;
}();
#endif

}  // namespace

HWY_EXPORT(PackRows);
HWY_EXPORT(PackQueries);
HWY_EXPORT(ComputeDistances);
HWY_EXPORT(KernelTargetName);

void PackRows(DescriptorMetric metric, const std::uint8_t* rows, int count, int row_bytes,
              std::uint8_t* tile, std::int32_t* constants) {
  HWY_DYNAMIC_DISPATCH(PackRows)(metric, rows, count, row_bytes, tile, constants);
}

void PackQueries(DescriptorMetric metric, const std::uint8_t* queries, int count, int row_bytes,
                 std::uint8_t* block, std::int32_t* constants) {
  HWY_DYNAMIC_DISPATCH(PackQueries)(metric, queries, count, row_bytes, block, constants);
}

void ComputeDistances(DescriptorMetric metric, int row_bytes, const std::uint8_t* block,
                      const std::int32_t* block_constants, const std::uint8_t* tile,
                      const std::int32_t* row_constants, int row_count, std::size_t row_stride,
                      std::uint32_t* distances) {
  HWY_DYNAMIC_DISPATCH(ComputeDistances)
  (metric, row_bytes, block, block_constants, tile, row_constants, row_count, row_stride,
   distances);
}

const char* KernelTargetName() { return HWY_DYNAMIC_DISPATCH(KernelTargetName)(); }

}  // namespace maploc::kernels
#endif  // HWY_ONCE
