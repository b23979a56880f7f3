// Bytes for the parsers: random ones, and valid ones that were damaged.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>

#include "tests/support/seed.h"

namespace maploc::testing {

inline std::chrono::duration<double> FuzzTime() {
  const char* seconds = std::getenv("MAPLOC_FUZZ_SECONDS");
  return std::chrono::duration<double>(seconds != nullptr ? std::atof(seconds) : 1.5);
}

inline std::string RandomBytes(Random& random) {
  std::string bytes(random.Below(300), '\0');
  for (char& byte : bytes) byte = static_cast<char>(random.Next());
  return bytes;
}

// Flips bits, overwrites, deletes, repeats or cuts: each keeps most of the message's structure.
inline void Mutate(Random& random, std::string* bytes) {
  if (bytes->empty()) return;
  const std::uint32_t at = random.Below(static_cast<std::uint32_t>(bytes->size()));
  switch (random.Below(5)) {
    case 0:
      (*bytes)[at] = static_cast<char>((*bytes)[at] ^ (1 << random.Below(8)));
      break;
    case 1:
      for (std::size_t i = at; i < std::min<std::size_t>(at + 8, bytes->size()); ++i) {
        (*bytes)[i] = random.Below(2) == 0 ? '\xff' : static_cast<char>(random.Next());
      }
      break;
    case 2:
      bytes->erase(at, 1 + random.Below(4));
      break;
    case 3:
      bytes->insert(at, bytes->substr(at, 1 + random.Below(16)));
      break;
    default:
      bytes->resize(at);
  }
}

inline std::string NextInput(Random& random, const std::string& valid) {
  if (random.Below(8) == 0) return RandomBytes(random);
  std::string bytes = valid;
  for (std::uint32_t i = 0; i <= random.Below(4); ++i) Mutate(random, &bytes);
  return bytes;
}

}  // namespace maploc::testing
