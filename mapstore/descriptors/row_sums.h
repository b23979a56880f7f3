// Sums over one descriptor row, compiled for the baseline in a file of their own: inside Highway
// 1.0's AVX3_DL region GCC may turn such a loop into AVX-VNNI, which Zen 4 and Ice Lake lack.
#pragma once

#include <cstdint>
#include <span>

namespace maploc::kernels {

std::int32_t SquaredNorm(std::span<const std::uint8_t> row);
std::int32_t Sum(std::span<const std::uint8_t> row);

}  // namespace maploc::kernels
