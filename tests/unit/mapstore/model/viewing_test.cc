#include "mapstore/model/viewing.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "mapstore/base/random.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

TEST(ViewingRangeTest, IsAConeAndDistances) {
  const std::vector<Eigen::Vector3d> centers = {{1, 2, 8}, {1, -2, 8}, {1, 0, 23}};
  const ViewingRange range = MakeViewingRange({1, 0, 3}, centers);
  ASSERT_TRUE(range.IsKnown());
  EXPECT_LT((range.toward_cameras_in_map - Eigen::Vector3f::UnitZ()).norm(), 1e-6f);
  EXPECT_FLOAT_EQ(range.max_angle_rad, std::atan(2.0f / 5.0f));
  EXPECT_FLOAT_EQ(range.min_distance, std::sqrt(29.0f));
  EXPECT_FLOAT_EQ(range.max_distance, 20.0f);
}

TEST(ViewingRangeTest, OneCameraIsAConeOfNoWidth) {
  const std::vector<Eigen::Vector3d> centers = {{3, 4, 0}};
  const ViewingRange range = MakeViewingRange({0, 0, 0}, centers);
  EXPECT_LT((range.toward_cameras_in_map - Eigen::Vector3f(0.6f, 0.8f, 0)).norm(), 1e-6f);
  EXPECT_NEAR(range.max_angle_rad, 0, 1e-6);
  EXPECT_EQ(range.min_distance, range.max_distance);
}

TEST(ViewingRangeTest, WithoutACameraAwayFromItNothingIsKnown) {
  EXPECT_FALSE(ViewingRange{}.IsKnown());
  EXPECT_FALSE(MakeViewingRange({1, 2, 3}, {}).IsKnown());
  const double huge = std::numeric_limits<double>::max();
  const std::vector<Eigen::Vector3d> useless = {{1, 2, 3}, {huge, huge, huge}};
  EXPECT_EQ(MakeViewingRange({1, 2, 3}, useless), ViewingRange{});
  const std::vector<Eigen::Vector3d> one_more = {{1, 2, 3}, {1, 2, 5}};
  EXPECT_EQ(MakeViewingRange({1, 2, 3}, one_more).min_distance, 2.0f);
}

TEST(ViewingRangeTest, DirectionsThatCancelOutAreSeenFromEverywhere) {
  const std::vector<Eigen::Vector3d> centers = {{0, 2, 0}, {0, -3, 0}};
  const ViewingRange range = MakeViewingRange({0, 0, 0}, centers);
  EXPECT_EQ(range.toward_cameras_in_map, Eigen::Vector3f(0, 1, 0));
  EXPECT_EQ(range.max_angle_rad, kPi);
  EXPECT_EQ(range.min_distance, 2.0f);
  EXPECT_EQ(range.max_distance, 3.0f);
}

TEST(ViewingRangeTest, HoldsEveryCameraWhateverTheScale) {
  Random random = testing::TestRandom();
  for (int repetition = 0; repetition < 200; ++repetition) {
    const double scale = std::pow(10.0, random.Uniform(-12, 12));
    const auto draw = [&] {
      return Eigen::Vector3d(scale * random.Gaussian(), scale * random.Gaussian(),
                             scale * random.Gaussian());
    };
    const Eigen::Vector3d position = draw();
    std::vector<Eigen::Vector3d> centers;
    for (std::uint64_t i = 0; i < 1 + random.Below(5); ++i) centers.push_back(draw());
    const ViewingRange range = MakeViewingRange(position, centers);
    EXPECT_NEAR(range.toward_cameras_in_map.norm(), 1.0f, 1e-6f);
    EXPECT_LE(range.max_angle_rad, kPi);
    for (const Eigen::Vector3d& center : centers) {
      const Eigen::Vector3d toward = center - position;
      const double cosine = toward.normalized().dot(range.toward_cameras_in_map.cast<double>());
      EXPECT_GE(cosine, std::cos(range.max_angle_rad) - 1e-6);
      EXPECT_GE(toward.norm(), range.min_distance * (1 - 1e-6));
      EXPECT_LE(toward.norm(), range.max_distance * (1 + 1e-6));
    }
  }
}

}  // namespace
}  // namespace maploc
