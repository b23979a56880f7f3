#include "mapstore/geometry/gravity.h"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/seed.h"

namespace maploc {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TEST(CameraFromAlignedTest, TurnsDownIntoGravity) {
  Random random = testing::TestRandom();
  std::vector<Eigen::Vector3d> gravities = {{0, 0, -1}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  gravities.push_back(Eigen::Vector3d(1e-9, 0, 1).normalized());
  gravities.push_back(Eigen::Vector3d(0, -1e-6, 1).normalized());
  for (int i = 0; i < 1000; ++i) {
    gravities.push_back(
        Eigen::Vector3d(random.Gaussian(), random.Gaussian(), random.Gaussian()).normalized());
  }
  for (const Eigen::Vector3d& gravity : gravities) {
    const Eigen::Quaterniond rotation = CameraFromAligned(gravity);
    EXPECT_NEAR(rotation.norm(), 1.0, 1e-14);
    EXPECT_LT((rotation * kGravityInMap - gravity).norm(), 1e-13) << gravity.transpose();
  }
}

// Level photos that look around: x axis level, y axis down but tilted, in a source frame where
// "down" is +z.
std::vector<Rigid3> LevelPhotos(Random& random, int count, double roll_sigma_rad) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < count; ++i) {
    const Eigen::Quaterniond level_camera_from_source(
        Eigen::AngleAxisd(random.Gaussian(roll_sigma_rad), Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(random.Uniform(-0.3, 0.3), Eigen::Vector3d::UnitX()) *
        Eigen::AngleAxisd(-90 * kDegree, Eigen::Vector3d::UnitX()).inverse() *
        Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()) *
        Eigen::AngleAxisd(random.Uniform(-3, 3), Eigen::Vector3d::UnitZ()));
    poses.push_back({level_camera_from_source, Eigen::Vector3d::Zero()});
  }
  return poses;
}

TEST(EstimateGravityTest, FindsDownFromLevelPhotos) {
  Random random = testing::TestRandom();
  const std::vector<Rigid3> poses = LevelPhotos(random, 50, 2 * kDegree);
  const double down = (poses[0].rotation.conjugate() * Eigen::Vector3d::UnitY()).z() > 0 ? 1 : -1;
  const GravityEstimate estimate = EstimateGravityFromPoses(poses);
  EXPECT_LT(AngleBetween(estimate.gravity_in_source, Eigen::Vector3d(0, 0, down)), 1.5 * kDegree);
  EXPECT_NEAR(estimate.spread_rad, 2 * kDegree, 1 * kDegree);
}

TEST(EstimateGravityTest, AdmitsThatOneDirectionSaysNothing) {
  const std::vector<Rigid3> poses(5, Rigid3{});
  EXPECT_DOUBLE_EQ(EstimateGravityFromPoses(poses).spread_rad, std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(EstimateGravityFromPoses({}).spread_rad, std::numbers::pi / 2);
}

}  // namespace
}  // namespace maploc
