#include "mapstore/geometry/gravity_reading.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace maploc {
namespace {

using ::testing::HasSubstr;

const Eigen::Vector3d kDown = Eigen::Vector3d(0.6, 0.0, -0.8);

TEST(GravityReadingTest, AUnitVectorAndMetresPerSecondSquaredMeanTheSame) {
  for (const double length : {1.0, 0.96, 1.04, 9.81, 9.80665, 8.0, 11.5}) {
    const Result<Eigen::Vector3d> down = DownFromReading("gravity", length * kDown);
    ASSERT_TRUE(down.ok()) << length << ": " << down.status().ToString();
    EXPECT_LT((*down - kDown).norm(), 1e-12) << length;
  }
}

TEST(GravityReadingTest, AnotherLengthIsRefusedWithTheCure) {
  for (const double length : {1e-9, 0.5, 0.9, 1.1, 2.0, 7.0, 12.5, 88.0, 981.0, 1e200}) {
    const Status status = DownFromReading("gravity", length * kDown).status();
    EXPECT_EQ(status.reason(), "IMPLAUSIBLE_GRAVITY") << length;
    EXPECT_THAT(status.message(), HasSubstr("divide it by that"));
  }
}

TEST(GravityReadingTest, ZeroAndWhatIsNotFiniteAreNoDirection) {
  EXPECT_EQ(DownFromReading("--gravity", {0, 0, 0}).status().reason(), "ZERO_GRAVITY");
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(DownFromReading("--gravity", {0, bad, 0}).status().reason(), "NOT_FINITE");
  }
}

TEST(GravityReadingTest, ASigmaIsAboveZeroAndWhatTheWireTakes) {
  for (const double good : {1e-6, 1.0, 90.0}) {
    EXPECT_TRUE(CheckGravitySigmaDeg("sigma", good).ok()) << good;
  }
  for (const double bad : {0.0, -1.0, 90.1, 180.0, std::nan("")}) {
    EXPECT_FALSE(CheckGravitySigmaDeg("sigma", bad).ok()) << bad;
  }
}

}  // namespace
}  // namespace maploc
