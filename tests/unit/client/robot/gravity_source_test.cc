#include "client/robot/gravity_source.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mapstore/geometry/gravity.h"
#include "tests/support/files.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

Rigid3 SomePose(Random& random) {
  Rigid3 pose;
  pose.rotation =
      Eigen::Quaterniond(random.Gaussian(), random.Gaussian(), random.Gaussian(), random.Gaussian())
          .normalized();
  pose.translation = {random.Gaussian(), random.Gaussian(), random.Gaussian()};
  return pose;
}

TEST(GravitySourceTest, WithoutNoiseItIsTheReferences) {
  Random random = testing::TestRandom();
  const Result<GravitySource> source = GravitySource::Create({});
  ASSERT_TRUE(source.ok());
  const Rigid3 pose = SomePose(random);
  const Result<Gravity> gravity = source->For("a", pose);
  ASSERT_TRUE(gravity.ok());
  EXPECT_LT(AngleBetween(gravity->direction_in_body, GravityInCamera(pose.rotation)), 1e-12);
  EXPECT_NEAR(gravity->sigma_rad, kMinGravitySigmaDeg * kRadPerDeg, 1e-12);
}

// The tilt about each horizontal axis of the map is normal with the given sigma, and independent.
TEST(GravitySourceTest, NoiseHasItsSigmaAboutEachHorizontalAxis) {
  Random random = testing::TestRandom();
  const double sigma_rad = 0.5 * kRadPerDeg;
  constexpr int kDraws = 20000;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Rigid3 pose = SomePose(random);
    const Eigen::Vector3d gravity = NoisyGravityInCamera(pose.rotation, sigma_rad, random);
    const Eigen::Vector2d tilt = (pose.rotation.conjugate() * gravity).head<2>();
    covariance += tilt * tilt.transpose() / kDraws;
  }
  const double variance = sigma_rad * sigma_rad;
  EXPECT_NEAR(covariance(0, 0) / variance, 1.0, 0.05);
  EXPECT_NEAR(covariance(1, 1) / variance, 1.0, 0.05);
  EXPECT_NEAR(covariance(0, 1) / variance, 0.0, 0.05);
}

TEST(GravitySourceTest, AnImagesNoiseDependsOnSeedAndNameAlone) {
  Random random = testing::TestRandom();
  const Rigid3 pose = SomePose(random);
  const auto direction = [&](std::uint64_t seed, const std::string& name) {
    GravityOptions options;
    options.noise_deg = 1.0;
    options.seed = seed;
    return GravitySource::Create(options)->For(name, pose)->direction_in_body;
  };
  EXPECT_EQ(direction(1, "a"), direction(1, "a"));
  EXPECT_NE(direction(1, "a"), direction(1, "b"));
  EXPECT_NE(direction(1, "a"), direction(2, "a"));
}

TEST(GravitySourceTest, SigmaSentIsTheNoiseUnlessSaidOtherwise) {
  GravityOptions options;
  options.noise_deg = 2.0;
  EXPECT_NEAR(GravitySource::Create(options)->For("a", Rigid3{})->sigma_rad, 2.0 * kRadPerDeg,
              1e-12);
  options.sigma_deg = 3.0;
  EXPECT_NEAR(GravitySource::Create(options)->For("a", Rigid3{})->sigma_rad, 3.0 * kRadPerDeg,
              1e-12);
}

TEST(GravitySourceTest, ACsvIsTakenAsItIsWithASigmaOfOneDegree) {
  const testing::TemporaryFolder folder;
  folder.Write("gravity.csv", "name,gx,gy,gz\na.png,0,0.6,0.8\n");
  GravityOptions options;
  options.csv = folder.File("gravity.csv");
  const Result<GravitySource> source = GravitySource::Create(options);
  ASSERT_TRUE(source.ok()) << source.status().ToString();
  const Result<Gravity> gravity = source->For("a.png", Rigid3{});
  ASSERT_TRUE(gravity.ok());
  EXPECT_LT((gravity->direction_in_body - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 1e-12);
  EXPECT_NEAR(gravity->sigma_rad, kRadPerDeg, 1e-12);
  EXPECT_EQ(source->For("b.png", Rigid3{}).status().reason(), "NO_GRAVITY");
}

TEST(GravitySourceTest, RefusesAnglesThatMakeNoSense) {
  for (const double degrees : {-1.0, 91.0, std::nan("")}) {
    GravityOptions options;
    options.noise_deg = degrees;
    EXPECT_EQ(GravitySource::Create(options).status().code(), StatusCode::kInvalidArgument);
  }
}

// The default for a noise of zero is the least that can be sent; a stated zero is a mistake.
TEST(GravitySourceTest, AStatedSigmaIsAboveZeroAndAtMostNinety) {
  for (const double degrees : {0.0, -1.0, 91.0, 180.0, std::nan("")}) {
    GravityOptions options;
    options.sigma_deg = degrees;
    EXPECT_EQ(GravitySource::Create(options).status().code(), StatusCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace maploc
