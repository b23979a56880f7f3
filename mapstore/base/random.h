// Randomness is handed in: a small, fast generator with a value seed (SplitMix64 seeding
// xoshiro256++, Blackman and Vigna 2019). The same seed gives the same stream on every platform,
// which std::uniform_* do not promise.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

namespace maploc {

// Not thread-safe; give each thread its own, by Fork.
class Random {
 public:
  using result_type = std::uint64_t;

  explicit Random(std::uint64_t seed);

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()() { return Next(); }

  std::uint64_t Next() {
    const std::uint64_t result = Rotate(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = Rotate(state_[3], 45);
    return result;
  }
  // Uniform in [0, n). REQUIRES: 0 < n. The bias is below n / 2^32 (Lemire's multiplication without
  // rejection).
  std::uint32_t Below(std::uint32_t n) {
    return static_cast<std::uint32_t>(((Next() >> 32) * n) >> 32);
  }
  // Uniform in [0, 1).
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1.0p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  // Normal with mean 0 and the given standard deviation (Box and Muller; two draws a call).
  double Gaussian(double sigma = 1.0);
  // An independent stream, named by `index`; does not change this one.
  Random Fork(std::uint64_t index) const;

 private:
  static constexpr std::uint64_t Rotate(std::uint64_t x, int k) {
    return (x << k) | (x >> (64 - k));
  }

  std::array<std::uint64_t, 4> state_;
};

// FNV-1a, for seeds made from names: the same on every machine.
std::uint64_t HashBytes(std::string_view bytes, std::uint64_t seed = 0xcbf29ce484222325ull);

}  // namespace maploc
