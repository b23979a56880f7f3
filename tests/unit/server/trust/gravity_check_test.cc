#include "server/trust/gravity_check.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

PoseProblem Measured(double about_x_deg, double about_y_deg, double sigma_deg) {
  PoseProblem problem;
  const Eigen::Vector3d turn(about_x_deg * kDegree, about_y_deg * kDegree, 0);
  const Eigen::AngleAxisd tilt(turn.norm(), turn.normalized());
  problem.gravity_in_camera = tilt * Eigen::Vector3d(0, 0, -1);  // the camera is the map
  problem.gravity_sigma_rad = sigma_deg * kDegree;
  return problem;
}

TEST(CompareGravity, IsChiSquareOfBothUncertainties) {
  RefinedPose pose;
  // sqrt(18.42) = 4.29 sigmas.
  EXPECT_TRUE(CompareGravity(Measured(4.2, 0, 1), pose).consistent);
  EXPECT_FALSE(CompareGravity(Measured(4.4, 0, 1), pose).consistent);
  EXPECT_NEAR(CompareGravity(Measured(3, 3, 1), pose).disagreement_rad, std::sqrt(18) * kDegree,
              1e-9);
  EXPECT_TRUE(CompareGravity(Measured(0.3, 0, 0.01), pose).consistent)
      << "no accelerometer is exact";
}

TEST(CompareGravity, CountsThePosesSpreadInItsDirection) {
  RefinedPose pose;
  pose.covariance(3, 3) = kDegree * kDegree;  // about the map's x axis alone
  EXPECT_TRUE(CompareGravity(Measured(6.0, 0, 1), pose).consistent);
  EXPECT_FALSE(CompareGravity(Measured(6.2, 0, 1), pose).consistent);
  EXPECT_FALSE(CompareGravity(Measured(0, 4.4, 1), pose).consistent);
}

// A robot that is pitched forward by 3 degrees about the map's x axis and does not know it, and one
// about y: the tilt has their signs.
TEST(CompareGravity, TellsWhichWay) {
  const RefinedPose pose;
  const GravityCheck about_x = CompareGravity(Measured(3, 0, 1), pose);
  EXPECT_LT((about_x.tilt_rad - Eigen::Vector2d(3 * kDegree, 0)).norm(), 1e-9);
  const GravityCheck about_y = CompareGravity(Measured(0, -2, 1), pose);
  EXPECT_LT((about_y.tilt_rad - Eigen::Vector2d(0, -2 * kDegree)).norm(), 1e-9);
}

// The same written out, without a turn: the camera is the map, z up, and feels down leaning towards
// +y, or +x. By the right hand it takes a turn about +x to bring (0, 0, -1) towards +y, and one
// about -y to bring it towards +x.
TEST(CompareGravity, TheTiltTurnsByTheRightHand) {
  const double lean = std::tan(0.05);
  PoseProblem problem;
  problem.gravity_sigma_rad = kDegree;
  problem.gravity_in_camera = Eigen::Vector3d(0, lean, -1).normalized();
  const Eigen::Vector2d towards_y = CompareGravity(problem, RefinedPose()).tilt_rad;
  EXPECT_NEAR(towards_y.x(), 0.05, 1e-9);
  EXPECT_NEAR(towards_y.y(), 0.0, 1e-9);
  problem.gravity_in_camera = Eigen::Vector3d(lean, 0, -1).normalized();
  const Eigen::Vector2d towards_x = CompareGravity(problem, RefinedPose()).tilt_rad;
  EXPECT_NEAR(towards_x.x(), 0.0, 1e-9);
  EXPECT_NEAR(towards_x.y(), -0.05, 1e-9);
}

SyntheticProblem WithGravityError(double error_deg, double sigma_deg, Random& random) {
  SyntheticOptions options;
  options.point_inliers = 20;
  options.gravity_noise_rad = options.gravity_sigma_rad = sigma_deg * kDegree;
  SyntheticProblem made = MakeSyntheticProblem(options, random);
  Eigen::Vector3d& gravity = made.problem.gravity_in_camera;
  gravity = Eigen::AngleAxisd(error_deg * kDegree, gravity.unitOrthogonal()) * gravity;
  return made;
}

// The refined pose gives way to a wrong gravity, in every mode; the check must not.
TEST(CheckGravity, SeesWhatAPulledPoseHides) {
  Random random = TestRandom();
  for (const Refinement mode : {Refinement::kAuto, Refinement::k4Dof, Refinement::k6Dof}) {
    RefineOptions options;
    options.mode = mode;
    options.max_reprojection_error_px = 20;
    for (int i = 0; i < 20; ++i) {
      const SyntheticProblem made = WithGravityError(6.0, 0.5, random);
      const RefinedPose pose = RefinePose(made.problem, made.camera_from_map, options);
      const GravityCheck check = CheckGravity(made.problem, pose, options);
      EXPECT_FALSE(check.consistent) << RefinementName(mode);
      EXPECT_NEAR(check.disagreement_rad, 6.0 * kDegree, 2.5 * kDegree);
    }
  }
}

// Calibrated: sound gravity is called inconsistent once in ten thousand, as p says.
TEST(CheckGravity, BelievesSoundGravity) {
  Random random = TestRandom();
  int inconsistent = 0;
  for (int i = 0; i < 2000; ++i) {
    const SyntheticProblem made = WithGravityError(0.0, 0.3, random);
    const RefinedPose pose = RefinePose(made.problem, made.camera_from_map, {});
    inconsistent += CheckGravity(made.problem, pose, {}).consistent ? 0 : 1;
  }
  EXPECT_LE(inconsistent, 2) << "of 2000; expected 0.2";
}

TEST(CheckGravity, FewMatchesContradictNothing) {
  Random random = TestRandom();
  SyntheticProblem made = WithGravityError(20.0, 0.5, random);
  made.problem.points.resize(2);
  RefinedPose pose = RefinePose(made.problem, made.camera_from_map, {});
  EXPECT_TRUE(CheckGravity(made.problem, pose, {}).consistent);
  made.problem.has_gravity = false;
  EXPECT_EQ(CheckGravity(made.problem, pose, {}).disagreement_rad, 0.0);
}

}  // namespace
}  // namespace maploc::testing
