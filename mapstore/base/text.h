// Numbers as operators read them.
#pragma once

#include <cstdint>
#include <string>

namespace maploc {

// Fixed point.
std::string FixedText(double value, int decimals);
// UTC, to the second (rounded down): "2026-11-25 16:08:10Z".
std::string UtcText(std::int64_t unix_ns);

}  // namespace maploc
