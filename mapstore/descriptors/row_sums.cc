#include "mapstore/descriptors/row_sums.h"

namespace maploc::kernels {

std::int32_t SquaredNorm(std::span<const std::uint8_t> row) {
  std::int32_t sum = 0;
  for (const std::uint8_t byte : row) sum += byte * byte;
  return sum;
}

std::int32_t Sum(std::span<const std::uint8_t> row) {
  std::int32_t sum = 0;
  for (const std::uint8_t byte : row) sum += byte;
  return sum;
}

}  // namespace maploc::kernels
