#include "server/trust/calibration.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

using MoveFn = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

// What the sent calibration makes of a picture that another lens took.
CalibrationCheck Check(int points, int lines, const MoveFn& move, Random& random) {
  SyntheticOptions options;
  options.point_inliers = points;
  options.point_outliers = points / 4;
  options.line_inliers = lines;
  SyntheticProblem made = MakeSyntheticProblem(options, random);
  for (PointCorrespondence& point : made.problem.points) point.normalized = move(point.normalized);
  for (LineCorrespondence& line : made.problem.lines) {
    line.normalized.start = move(line.normalized.start);
    line.normalized.end = move(line.normalized.end);
  }
  made.problem.has_gravity = false;
  const RefinedPose pose = RefinePose(made.problem, made.camera_from_map, {});
  return CheckCalibration(made.problem, pose, 4.0);
}

TEST(CheckCalibration, BelievesTheTrueLens) {
  Random random = TestRandom();
  for (int i = 0; i < 100; ++i) {
    const CalibrationCheck check = Check(
        150, 20, [](const Eigen::Vector2d& seen) { return seen; }, random);
    EXPECT_TRUE(check.consistent) << i;
    ASSERT_TRUE(check.focal_scale.has_value());
    EXPECT_LT(std::abs(check.focal_scale->scale - 1.0), 5.0 * check.focal_scale->sigma + 0.001);
  }
}

TEST(CheckCalibration, TellsAFocalLengthThatIsTenPercentOff) {
  Random random = TestRandom();
  int refused = 0;
  for (int i = 0; i < 50; ++i) {
    // Sent 10% too short: everything seems further from the axis.
    const CalibrationCheck check = Check(
        150, 20, [](const Eigen::Vector2d& seen) -> Eigen::Vector2d { return 1.1 * seen; }, random);
    refused += check.consistent ? 0 : 1;
    ASSERT_TRUE(check.focal_scale.has_value());
    EXPECT_NEAR(check.focal_scale->scale, 1.1, 5.0 * check.focal_scale->sigma + 0.005);
  }
  EXPECT_GE(refused, 45);
}

TEST(CheckCalibration, SeesDistortionThatNobodyDeclared) {
  Random random = TestRandom();
  int refused = 0;
  for (int i = 0; i < 50; ++i) {
    refused += Check(
                   300, 0,
                   [](const Eigen::Vector2d& seen) -> Eigen::Vector2d {
                     return seen * (1.0 - 0.6 * seen.squaredNorm());
                   },
                   random)
                       .consistent
                   ? 0
                   : 1;
  }
  EXPECT_GE(refused, 40);
}

// A tilted sheet, 545 pixels a radian and 4 m away, seen with `perspective` times the perspective
// that the sent lens gives it, and where the map has it bent by `bend_m` at its border.
CalibrationCheck CheckSheet(double tilt_rad, double perspective, double bend_m, Random& random) {
  PoseProblem problem;
  problem.focal_length_px = 545.0;
  problem.has_gravity = false;
  const Rigid3 camera_from_map{
      Eigen::Quaterniond(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX())), {0.0, 0.0, 4.0}};
  for (int k = 0; k < 120; ++k) {
    const Eigen::Vector3d flat(random.Uniform(-1.0, 1.0), random.Uniform(-0.8, 0.8), 0.0);
    const Eigen::Vector3d seen = camera_from_map * flat;
    const double depth = 4.0 + perspective * (seen.z() - 4.0);
    const Eigen::Vector2d noise(random.Gaussian(0.5), random.Gaussian(0.5));
    const Eigen::Vector3d in_map = flat + Eigen::Vector3d(0.0, 0.0, bend_m * flat.squaredNorm());
    problem.points.push_back({seen.head<2>() / depth + noise / 545.0, in_map});
  }
  const RefinedPose pose = RefinePose(problem, camera_from_map, {});
  return CheckCalibration(problem, pose, 4.0);
}

// Without any perspective a picture fits better the longer the lens, and none fits best.
TEST(CheckCalibration, SeesALensThatIsManyTimesAsLong) {
  Random random = TestRandom();
  int refused = 0;
  for (int i = 0; i < 50; ++i) refused += CheckSheet(0.5, 0.0, 0.0, random).consistent ? 0 : 1;
  EXPECT_GE(refused, 48);
}

// A sheet that the map has a little bent fits better the longer the lens, too, but not much better:
// right answers about photos of a hand-held sheet were refused for it.
TEST(CheckCalibration, ABentMapIsNoOtherLens) {
  Random random = TestRandom();
  int refused = 0;
  for (int i = 0; i < 50; ++i) refused += CheckSheet(0.2, 1.0, -0.1, random).consistent ? 0 : 1;
  EXPECT_LE(refused, 1);
}

// A wall 2.3 m away, seen at an angle of `tilt_rad` with the true lens; its landmarks have errors
// of depth.
CalibrationCheck CheckWall(double tilt_rad, double noise_px, double depth_error_m, Random& random) {
  PoseProblem problem;
  problem.focal_length_px = 500.0;
  problem.has_gravity = false;
  const Rigid3 camera_from_map{
      Eigen::Quaterniond(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX())), {0.0, 0.0, 2.3}};
  for (int k = 0; k < 480; ++k) {
    const Eigen::Vector3d flat(random.Uniform(-1.2, 1.2), random.Uniform(-1.0, 1.0), 0.0);
    const Eigen::Vector2d noise(random.Gaussian(noise_px), random.Gaussian(noise_px));
    const Eigen::Vector3d in_map = flat + Eigen::Vector3d(0.0, 0.0, random.Gaussian(depth_error_m));
    problem.points.push_back({(camera_from_map * flat).hnormalized() + noise / 500.0, in_map});
  }
  return CheckCalibration(problem, RefinePose(problem, camera_from_map, {}), 4.0);
}

// Where errors were measured in a picture that the fit may shrink, noise alone asked for a longer
// lens: in front of this wall for one 30% longer, in 50 of 50 queries.
TEST(CheckCalibration, NoiseAsksForNoLongerLens) {
  Random random = TestRandom();
  SCOPED_TRACE(::testing::Message() << "seed " << TestSeed());
  for (const double tilt_rad : {0.1, 0.25, 0.6}) {
    int refused = 0;
    for (int i = 0; i < 50; ++i)
      refused += CheckWall(tilt_rad, 0.3, 0.0, random).consistent ? 0 : 1;
    EXPECT_EQ(refused, 0) << tilt_rad;
  }
}

TEST(CheckCalibration, SaysHowFarErrorsOfDepthMayMislead) {
  Random random = TestRandom();
  SCOPED_TRACE(::testing::Message() << "seed " << TestSeed());
  int told = 0;
  for (int i = 0; i < 150; ++i) {
    const auto focal =
        CheckWall(i % 3 == 0 ? 0.25 : 0.6, 0.3, i % 2 == 0 ? 0.01 : 0.003, random).focal_scale;
    if (!focal) continue;
    ++told;
    EXPECT_LT(std::abs(std::log(focal->scale)), 4.0 * focal->sigma) << i;
  }
  EXPECT_GE(told, 90);
}

TEST(CheckCalibration, HasNoOpinionOfAHandfulOfMatches) {
  Random random = TestRandom();
  const CalibrationCheck check = Check(
      10, 0, [](const Eigen::Vector2d& seen) { return seen; }, random);
  EXPECT_TRUE(check.consistent);
  EXPECT_FALSE(check.focal_scale.has_value());
  // Then the pose is as uncertain as lenses usually are.
  EXPECT_GT(check.covariance(0, 0), 0.0);
}

}  // namespace
}  // namespace maploc::testing
