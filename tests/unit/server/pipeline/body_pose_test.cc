#include "server/pipeline/body_pose.h"

#include <gtest/gtest.h>

#include "tests/support/seed.h"

namespace maploc {
namespace {

Rigid3 RandomPose(Random& random) {
  const Eigen::Vector3d axis(random.Gaussian(), random.Gaussian(), random.Gaussian());
  return {Eigen::Quaterniond(Eigen::AngleAxisd(random.Uniform(0, 3), axis.normalized())),
          {random.Gaussian(), random.Gaussian(), random.Gaussian()}};
}

// map_from_camera moved by (dp, dtheta about the map's fixed axes).
Rigid3 Perturb(const Rigid3& map_from_camera, const Eigen::Matrix<double, 6, 1>& change) {
  const Eigen::Vector3d turn = change.tail<3>();
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  return {rotation * map_from_camera.rotation, map_from_camera.translation + change.head<3>()};
}

// The linear map of the covariance against finite differences of the pose itself.
TEST(BodyPoseTest, CovarianceFollowsThePose) {
  Random random = testing::TestRandom();
  const Rigid3 camera_from_map = RandomPose(random);
  const Rigid3 camera_from_body = RandomPose(random);
  const Rigid3 map_from_body = MapFromBody(camera_from_map, camera_from_body);
  PoseCovariance jacobian;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 6; ++i) {
    Eigen::Matrix<double, 6, 1> change = Eigen::Matrix<double, 6, 1>::Zero();
    change[i] = kStep;
    const Rigid3 moved =
        MapFromBody(Perturb(camera_from_map.Inverse(), change).Inverse(), camera_from_body);
    const Eigen::AngleAxisd turn(moved.rotation * map_from_body.rotation.conjugate());
    jacobian.col(i).head<3>() = (moved.translation - map_from_body.translation) / kStep;
    jacobian.col(i).tail<3>() = turn.angle() * turn.axis() / kStep;
  }
  PoseCovariance root;
  for (double& value : root.reshaped()) value = random.Gaussian();
  const PoseCovariance covariance = root * root.transpose();
  const PoseCovariance want = jacobian * covariance * jacobian.transpose();
  EXPECT_TRUE(BodyCovariance(covariance, camera_from_map, camera_from_body).isApprox(want, 1e-4));
}

TEST(BodyPoseTest, TheCameraAsBodyChangesNothing) {
  Random random = testing::TestRandom();
  const Rigid3 camera_from_map = RandomPose(random);
  const PoseCovariance covariance = PoseCovariance::Identity() * 2.0;
  EXPECT_TRUE(BodyCovariance(covariance, camera_from_map, {}).isApprox(covariance));
  const Rigid3 map_from_body = MapFromBody(camera_from_map, {});
  EXPECT_TRUE((map_from_body * Eigen::Vector3d::Zero())
                  .isApprox(camera_from_map.Inverse() * Eigen::Vector3d::Zero()));
}

}  // namespace
}  // namespace maploc
