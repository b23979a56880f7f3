#include "mapstore/base/text.h"

#include <limits>

#include <gtest/gtest.h>

namespace maploc {
namespace {

TEST(FixedText, HoldsTheLargestNumber) {
  EXPECT_EQ(FixedText(0.73449, 3), "0.734");
  EXPECT_EQ(FixedText(-std::numeric_limits<double>::max(), 1).size(), 1 + 309 + 2u);
}

TEST(UtcText, RoundsDownAlsoBefore1970) {
  EXPECT_EQ(UtcText(0), "1970-01-01 00:00:00Z");
  EXPECT_EQ(UtcText(1'764'086'890'999'999'999), "2025-11-25 16:08:10Z");
  EXPECT_EQ(UtcText(-1), "1969-12-31 23:59:59Z");
  EXPECT_EQ(UtcText(std::numeric_limits<std::int64_t>::min()), "1677-09-21 00:12:43Z");
}

}  // namespace
}  // namespace maploc
