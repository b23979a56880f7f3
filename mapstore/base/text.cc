#include "mapstore/base/text.h"

#include <array>
#include <cstdio>
#include <ctime>

namespace maploc {

std::string FixedText(double value, int decimals) {
  std::array<char, 350> text;  // the largest double has 309 digits
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string UtcText(std::int64_t unix_ns) {
  constexpr std::int64_t kNanos = 1'000'000'000;
  std::time_t seconds = unix_ns / kNanos;
  // Division rounds towards zero, but a time before 1970 must round down.
  if (unix_ns % kNanos < 0) --seconds;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 64> text;
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%SZ", &utc);
  return text.data();
}

}  // namespace maploc
