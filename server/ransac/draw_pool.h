// The pool of matches to draw from: it begins with the best matches and grows to all of them, by
// PROSAC's growth function (Chum and Matas, "Matching with PROSAC", CVPR 2005) for two entities.
//
// PROSAC draws from the n best of N matches until T_n = T_N C(n, m) / C(N, m) draws are made. With
// m = 2 the pool after t draws is n(t) = N sqrt(t / T_N). Deviations:
// * The pool of every kind of feature grows by the same share.
// * A draw is uniform in its pools. Two draws of one pool are therefore independent, and a useless
//   order costs nothing on average.
// * T_N is half of the matches instead of 200,000: the ratio of a match says little in another
//   season, so the order deserves no more trust.
// The stop rule does not depend on the order.
#pragma once

#include <cstdint>

namespace maploc {

// Not thread-safe.
class DrawPool {
 public:
  // `matches`: N, of all kinds. Not `has_quality`: the pool is everything from the first draw on.
  DrawPool(std::uint32_t matches, bool has_quality);

  void Advance();  // one draw was made
  // Of `count` matches of one kind, how many are in the pool: at least min(count, kLeast).
  std::uint32_t SizeOf(std::uint32_t count) const;

  static constexpr std::uint32_t kLeast = 8;

 private:
  double draws_to_all_;  // T_N
  double draws_ = 1.0;   // t
  double share_ = 1.0;   // n(t) / N
};

}  // namespace maploc
