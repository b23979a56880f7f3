#include "mapstore/geometry/line.h"

#include <numbers>

#include <gtest/gtest.h>

namespace maploc {
namespace {

LineSegment3 TiltedBy(double degrees) {
  const double tilt = degrees * std::numbers::pi / 180;
  return {{1, 2, 3}, {1 + std::sin(tilt), 2, 3 - std::cos(tilt)}};
}

TEST(LineTest, TiltCountsFromTheVerticalEitherWayUp) {
  for (const double degrees : {0.0, 5.0, 45.0, 90.0}) {
    EXPECT_NEAR(TiltFromVertical(TiltedBy(degrees)), degrees * std::numbers::pi / 180, 1e-12);
    const LineSegment3 line = TiltedBy(degrees);
    EXPECT_NEAR(TiltFromVertical({line.end, line.start}), TiltFromVertical(line), 1e-15);
  }
}

TEST(LineTest, UsableMeansTenDegreesOrMore) {
  EXPECT_FALSE(IsUsableLine(TiltedBy(0)));
  EXPECT_FALSE(IsUsableLine(TiltedBy(9.99)));
  EXPECT_TRUE(IsUsableLine(TiltedBy(10.01)));
  EXPECT_FALSE(IsUsableLine({{1, 1, 1}, {1, 1, 1}})) << "a segment without length";
}

}  // namespace
}  // namespace maploc
