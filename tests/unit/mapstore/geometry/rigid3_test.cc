#include "mapstore/geometry/rigid3.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/seed.h"

namespace maploc {
namespace {

Eigen::Vector3d RandomVector(Random& random, double size) {
  return {random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
}

Eigen::Quaterniond RandomRotation(Random& random) {
  return Eigen::Quaterniond(random.Gaussian(), random.Gaussian(), random.Gaussian(),
                            random.Gaussian())
      .normalized();
}

TEST(Rigid3Test, ProductIsOneTransformAfterTheOther) {
  Random random = testing::TestRandom();
  const Rigid3 b_from_a{RandomRotation(random), RandomVector(random, 10)};
  const Rigid3 c_from_b{RandomRotation(random), RandomVector(random, 10)};
  const Eigen::Vector3d point_in_a = RandomVector(random, 10);
  const Rigid3 c_from_a = c_from_b * b_from_a;
  EXPECT_LT((c_from_a * point_in_a - c_from_b * (b_from_a * point_in_a)).norm(), 1e-12);
  EXPECT_LT((c_from_a.Inverse() * (c_from_a * point_in_a) - point_in_a).norm(), 1e-12);
}

TEST(Similarity3Test, InverseUndoes) {
  Random random = testing::TestRandom();
  const Similarity3 b_from_a{2.5, RandomRotation(random), RandomVector(random, 10)};
  const Eigen::Vector3d point_in_a = RandomVector(random, 10);
  EXPECT_LT((b_from_a.Inverse() * (b_from_a * point_in_a) - point_in_a).norm(), 1e-12);
}

TEST(Similarity3Test, ProductIsOneTransformAfterTheOther) {
  Random random = testing::TestRandom();
  const Similarity3 b_from_a{2.5, RandomRotation(random), RandomVector(random, 10)};
  const Similarity3 c_from_b{0.3, RandomRotation(random), RandomVector(random, 10)};
  const Eigen::Vector3d point_in_a = RandomVector(random, 10);
  const Similarity3 c_from_a = c_from_b * b_from_a;
  EXPECT_LT((c_from_a * point_in_a - c_from_b * (b_from_a * point_in_a)).norm(), 1e-12);
  const Similarity3 a_from_a = b_from_a.Inverse() * b_from_a;
  EXPECT_NEAR(a_from_a.scale, 1.0, 1e-15);
  EXPECT_LT((a_from_a * point_in_a - point_in_a).norm(), 1e-12);
}

// A client compares answers with references through this: the moved camera sees the moved world in
// the same directions, at scaled depths.
TEST(MovePoseTest, KeepsDirectionsAndScalesDepths) {
  Random random = testing::TestRandom();
  const Similarity3 map_from_source{0.3, RandomRotation(random), RandomVector(random, 10)};
  const Rigid3 camera_from_source{RandomRotation(random), RandomVector(random, 10)};
  const Rigid3 camera_from_map = MovePose(map_from_source, camera_from_source);
  const Eigen::Vector3d point_in_source = RandomVector(random, 10);
  const Eigen::Vector3d seen_before = camera_from_source * point_in_source;
  const Eigen::Vector3d seen_after = camera_from_map * (map_from_source * point_in_source);
  EXPECT_LT((seen_after - 0.3 * seen_before).norm(), 1e-12);
}

TEST(RotationAngleTest, IsAccurateFromZeroToHalfATurn) {
  Random random = testing::TestRandom();
  for (const double angle : {0.0, 1e-12, 1e-6, 0.5, 3.0, std::numbers::pi}) {
    const Eigen::Quaterniond a = RandomRotation(random);
    const Eigen::Quaterniond b = a * Eigen::AngleAxisd(angle, RandomVector(random, 1).normalized());
    EXPECT_NEAR(RotationAngleBetween(a, b), angle, 1e-14 + 1e-14 * angle);
    const Eigen::Quaterniond same_as_b(-b.w(), -b.x(), -b.y(), -b.z());
    EXPECT_NEAR(RotationAngleBetween(a, same_as_b), angle, 1e-14 + 1e-14 * angle);
  }
}

}  // namespace
}  // namespace maploc
