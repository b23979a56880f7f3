#include "server/refinement/refine.h"

#include <numbers>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "mapstore/geometry/gravity.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

SyntheticOptions TenAndTen(double gravity_sigma_deg) {
  SyntheticOptions options;
  options.point_inliers = 10;
  options.line_inliers = 10;
  options.gravity_noise_rad = options.gravity_sigma_rad = gravity_sigma_deg * kDegree;
  return options;
}

Rigid3 Disturbed(const Rigid3& pose, Random& random) {
  const Eigen::AngleAxisd turn(0.3 * kDegree, RandomDirection(random));
  return {(turn * pose.rotation).normalized(), pose.translation + 0.02 * RandomDirection(random)};
}

RefineOptions Mode(Refinement mode) {
  RefineOptions options;
  options.mode = mode;
  options.max_reprojection_error_px = 6.0;
  return options;
}

TEST(RefinePose, FindsTheExactPoseWithoutNoise) {
  Random random = TestRandom();
  for (const Refinement mode : {Refinement::kAuto, Refinement::k4Dof, Refinement::k6Dof}) {
    for (int i = 0; i < 30; ++i) {
      SyntheticOptions synthetic = TenAndTen(0);
      synthetic.noise_px = 0;
      const SyntheticProblem made = MakeSyntheticProblem(synthetic, random);
      const RefinedPose refined =
          RefinePose(made.problem, Disturbed(made.camera_from_map, random), Mode(mode));
      ASSERT_TRUE(refined.converged);
      const PoseError error = ComparePoses(refined.camera_from_map, made.camera_from_map);
      EXPECT_LT(error.rotation_rad, 1e-7) << RefinementName(mode);
      EXPECT_LT(error.position, 1e-7);
    }
  }
}

double GravityDisagreement(const RefinedPose& pose, const PoseProblem& problem) {
  return AngleBetween(GravityInCamera(pose.camera_from_map.rotation), problem.gravity_in_camera);
}

TEST(RefinePose, FourDofHoldsGravityAndSixForgetsIt) {
  Random random = TestRandom();
  const SyntheticProblem made = MakeSyntheticProblem(TenAndTen(2.0), random);
  const RefinedPose held = RefinePose(made.problem, made.camera_from_map, Mode(Refinement::k4Dof));
  EXPECT_LT(GravityDisagreement(held, made.problem), 1e-9);
  const RefinedPose free = RefinePose(made.problem, made.camera_from_map, Mode(Refinement::k6Dof));
  EXPECT_NEAR(
      GravityDisagreement(free, made.problem),
      AngleBetween(GravityInCamera(made.camera_from_map.rotation), made.problem.gravity_in_camera),
      1.0 * kDegree);
}

TEST(RefinePose, WithoutGravityTheModeIsSixDof) {
  Random random = TestRandom();
  SyntheticProblem made = MakeSyntheticProblem(TenAndTen(0), random);
  made.problem.has_gravity = false;
  made.problem.gravity_in_camera.setZero();
  const RefinedPose refined =
      RefinePose(made.problem, made.camera_from_map, Mode(Refinement::kAuto));
  ASSERT_TRUE(refined.converged);
  EXPECT_TRUE(refined.covariance.allFinite());
  EXPECT_LT(ComparePoses(refined.camera_from_map, made.camera_from_map).position, 0.2);
}

TEST(RefinePose, WrongMatchesInsideTheRoundsAreDropped) {
  Random random = TestRandom();
  SyntheticOptions synthetic = TenAndTen(0.5);
  synthetic.point_inliers = 40;
  synthetic.point_outliers = 60;
  for (int i = 0; i < 20; ++i) {
    const SyntheticProblem made = MakeSyntheticProblem(synthetic, random);
    const RefinedPose refined =
        RefinePose(made.problem, Disturbed(made.camera_from_map, random), Mode(Refinement::kAuto));
    ASSERT_TRUE(refined.converged);
    EXPECT_LT(ComparePoses(refined.camera_from_map, made.camera_from_map).position, 0.05);
  }
}

TEST(RefinePose, TooFewFeaturesDoNotConverge) {
  Random random = TestRandom();
  SyntheticOptions synthetic;
  synthetic.point_inliers = 1;
  const SyntheticProblem made = MakeSyntheticProblem(synthetic, random);
  EXPECT_FALSE(RefinePose(made.problem, made.camera_from_map, {}).converged);
  EXPECT_FALSE(RefinePose(PoseProblem{}, Rigid3{}, {}).converged);
}

TEST(RefinePose, AMapFarFromItsOriginIsNoOther) {
  Random random = TestRandom();
  const Eigen::Vector3d away(4e5, -3e5, 200);
  const SyntheticProblem made = MakeSyntheticProblem(TenAndTen(0.5), random);
  const RefinedPose here = RefinePose(made.problem, made.camera_from_map, {});
  const SyntheticProblem moved = MovedBy(away, made);
  const RefinedPose there = RefinePose(moved.problem, moved.camera_from_map, {});
  EXPECT_LT((there.camera_from_map.Inverse().translation - away -
             here.camera_from_map.Inverse().translation)
                .norm(),
            1e-6);
  EXPECT_LT((there.covariance - here.covariance).norm(), 1e-3 * here.covariance.norm());
}

using Vector6 = Eigen::Matrix<double, 6, 1>;

// Error of map_from_camera in the covariance's order: position, rotation vector in map axes.
Vector6 ErrorVector(const Rigid3& estimate, const Rigid3& truth) {
  const Rigid3 map_from_camera = estimate.Inverse();
  const Rigid3 true_map_from_camera = truth.Inverse();
  const Eigen::AngleAxisd turn(map_from_camera.rotation *
                               true_map_from_camera.rotation.conjugate());
  Vector6 error;
  error << map_from_camera.translation - true_map_from_camera.translation,
      turn.angle() * turn.axis();
  return error;
}

double MeanNees(Refinement mode, double gravity_sigma_deg, int poses) {
  Random random = TestRandom();
  double sum = 0;
  for (int i = 0; i < poses; ++i) {
    const SyntheticProblem made = MakeSyntheticProblem(TenAndTen(gravity_sigma_deg), random);
    RefineOptions options = Mode(mode);
    options.max_reprojection_error_px = 20.0;  // held gravity moves good matches by some pixels
    const RefinedPose refined = RefinePose(made.problem, made.camera_from_map, options);
    const Vector6 error = ErrorVector(refined.camera_from_map, made.camera_from_map);
    sum += error.dot(refined.covariance.ldlt().solve(error));
  }
  return sum / poses;
}

// Six degrees of freedom: the mean of the normalized error squared is 6 when the covariance is
// right, and that of 5000 poses has a standard deviation of 0.05.
TEST(Covariance, IsAsLargeAsTheErrors) {
  for (const Refinement mode : {Refinement::kAuto, Refinement::k4Dof, Refinement::k6Dof}) {
    const double nees = MeanNees(mode, 0.5, 5000);
    EXPECT_GT(nees, 5.7) << RefinementName(mode);
    EXPECT_LT(nees, 6.3) << RefinementName(mode);
  }
}

TEST(Covariance, IsNeverZeroInRollAndPitch) {
  Random random = TestRandom();
  const SyntheticProblem made = MakeSyntheticProblem(TenAndTen(0), random);
  for (const Refinement mode : {Refinement::kAuto, Refinement::k4Dof}) {
    const RefinedPose refined = RefinePose(made.problem, made.camera_from_map, Mode(mode));
    const Eigen::SelfAdjointEigenSolver<PoseCovariance> eigen(refined.covariance);
    EXPECT_GT(eigen.eigenvalues().minCoeff(), 0) << RefinementName(mode);
    EXPECT_GT(refined.covariance(3, 3), 1e-9);
    EXPECT_GT(refined.covariance(4, 4), 1e-9);
  }
}

TEST(Covariance, HeldGravityCarriesGravitysSigma) {
  Random random = TestRandom();
  const SyntheticProblem made = MakeSyntheticProblem(TenAndTen(2.0), random);
  const RefinedPose refined =
      RefinePose(made.problem, made.camera_from_map, Mode(Refinement::k4Dof));
  const double expected = 4.0 * kDegree * kDegree;
  EXPECT_NEAR(refined.covariance(3, 3), expected, 0.05 * expected);
  EXPECT_NEAR(refined.covariance(4, 4), expected, 0.05 * expected);
}

}  // namespace
}  // namespace maploc::testing
