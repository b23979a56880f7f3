// The two nearest landmarks of a descriptor, and how they are kept while rows arrive.
#pragma once

#include <cstdint>

namespace maploc {

// Best and second best landmark of one query descriptor. Distances: bits (Hamming), or squared
// (L2).
struct Neighbours {
  std::int32_t best = -1;  // landmark; -1 when there are none
  std::uint32_t best_distance = 0;
  std::uint32_t second_distance =
      UINT32_MAX;  // of the best row of ANOTHER landmark; UINT32_MAX when there is none

  // Takes the next row. Rows arrive in ascending order and strict comparisons let the lower row win
  // a tie. REQUIRES: distance < second_distance.
  void Insert(std::int32_t landmark, std::uint32_t distance) {
    const bool is_best = best < 0 || distance < best_distance;
    if (landmark == best) {
      best_distance = is_best ? distance : best_distance;
    } else if (is_best) {
      if (best >= 0) second_distance = best_distance;
      best = landmark;
      best_distance = distance;
    } else {
      second_distance = distance;
    }
  }
};

}  // namespace maploc
