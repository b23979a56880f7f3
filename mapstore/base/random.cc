#include "mapstore/base/random.h"

#include <cmath>
#include <numbers>

namespace maploc {
namespace {

std::uint64_t SplitMix64(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed) {
  // xoshiro must not start with zeros alone. SplitMix64 never gives four zeros in a row.
  for (std::uint64_t& word : state_) word = SplitMix64(seed);
}

double Random::Gaussian(double sigma) {
  // Uniform() may be 0 but never 1, so the logarithm of 1 - Uniform() is finite.
  const double radius = std::sqrt(-2.0 * std::log1p(-Uniform()));
  return sigma * radius * std::cos(2.0 * std::numbers::pi * Uniform());
}

Random Random::Fork(std::uint64_t index) const {
  std::uint64_t mixed = index;
  return Random(state_[0] ^ Rotate(state_[2], 32) ^ SplitMix64(mixed));
}

std::uint64_t HashBytes(std::string_view bytes, std::uint64_t seed) {
  std::uint64_t hash = seed;
  for (const char byte : bytes) {
    hash ^= static_cast<unsigned char>(byte);
    // The prime of 64-bit FNV-1a. Checksums in stores are made with it, so it never changes.
    hash *= 0x100000001b3ull;
  }
  return hash;
}

}  // namespace maploc
