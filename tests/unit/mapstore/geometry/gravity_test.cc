#include "mapstore/geometry/gravity.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/support/seed.h"

namespace maploc {
namespace {

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

}  // namespace
}  // namespace maploc
