// Numbers of 4 and 8 bytes as bytes, little-endian on every machine, and back. Only for this
// folder.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace maploc {

template <typename T>
using BitsOf = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;

template <typename T>
void AppendLittleEndian(T value, std::vector<std::uint8_t>& bytes) {
  const auto bits = std::bit_cast<BitsOf<T>>(value);
  for (std::size_t byte = 0; byte < sizeof(T); ++byte) {
    bytes.push_back(static_cast<std::uint8_t>(bits >> (8 * byte)));
  }
}

// REQUIRES: sizeof(T) bytes.
template <typename T>
T ReadLittleEndian(const std::uint8_t* bytes) {
  BitsOf<T> bits = 0;
  for (std::size_t byte = 0; byte < sizeof(T); ++byte) {
    bits |= static_cast<BitsOf<T>>(bytes[byte]) << (8 * byte);
  }
  return std::bit_cast<T>(bits);
}

}  // namespace maploc
