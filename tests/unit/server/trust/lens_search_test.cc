#include "server/trust/lens_search.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "server/ransac/estimator.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr int kProblems = 40;
constexpr double kFocalPx = 458.0;
constexpr double kThresholdPx = 4.0;
// 12 degrees, about the 100 pixels of a principal point that is off.
constexpr double kTurnRad = 0.21;

// Its distortion is about the one of EuRoC's cameras.
Camera BarrelCamera(double focal_px, const Eigen::Vector2d& centre_px) {
  return Camera::Create(CameraModel::kRadial, 752, 480,
                        {focal_px, centre_px.x(), centre_px.y(), -0.28, 0.07})
      .value();
}

const Eigen::Vector2d kCentrePx(375.5, 239.5);

// 40 true matches among 60 wrong ones, with the gravity that was measured.
PoseProblem TrueProblem(Random& random) {
  SyntheticOptions options;
  options.point_inliers = 40;
  options.point_outliers = 60;
  options.gravity_noise_rad = 0.005;
  options.gravity_sigma_rad = 0.01;
  options.focal_length_px = kFocalPx;
  return MakeSyntheticProblem(options, random).problem;
}

// What the sent calibration makes of it.
PoseProblem As(const Camera& sent, PoseProblem problem) {
  const Camera camera = BarrelCamera(kFocalPx, kCentrePx);
  problem.focal_length_px = sent.MeanFocalLengthPx();
  std::erase_if(problem.points, [&](PointCorrespondence& point) {
    const auto pixel = camera.Project(point.normalized.homogeneous());
    const auto normalized = pixel ? sent.Normalize(*pixel) : std::nullopt;
    if (normalized) point.normalized = *normalized;
    return !normalized;
  });
  return problem;
}

bool IsRefused(const PoseProblem& problem, const Camera& sent, bool gravity_rejected,
               Random& random) {
  PoseProblem believed = problem;
  believed.has_gravity = !gravity_rejected;
  RansacOptions ransac;
  ransac.strategy = gravity_rejected ? Strategy::kP3P : Strategy::k2P;
  ransac.seed = random.Next();
  const Consensus consensus = EstimateConsensus(believed, ransac);
  EXPECT_TRUE(consensus.found);
  const RefinedPose pose = RefinePose(believed, consensus.camera_from_map, {});
  return AgreesBetterThroughAnotherLens(believed, pose, sent, gravity_rejected, kThresholdPx);
}

TEST(LensSearch, BelievesTheTrueLens) {
  Random random = TestRandom();
  SCOPED_TRACE(::testing::Message() << "seed " << TestSeed());
  const Camera sent = BarrelCamera(kFocalPx, kCentrePx);
  int refused = 0;
  for (int i = 0; i < kProblems; ++i) {
    refused += IsRefused(As(sent, TrueProblem(random)), sent, false, random) ? 1 : 0;
  }
  EXPECT_EQ(refused, 0);
}

// The distortion makes this no change of scale in the undistorted plane, where a fit that starts at
// the matches that agree finds nothing.
TEST(LensSearch, FindsAFocalLengthThatIsFarOff) {
  Random random = TestRandom();
  SCOPED_TRACE(::testing::Message() << "seed " << TestSeed());
  for (const double factor : {0.6, 1.6}) {
    const Camera sent = BarrelCamera(factor * kFocalPx, kCentrePx);
    int refused = 0;
    for (int i = 0; i < kProblems; ++i) {
      refused += IsRefused(As(sent, TrueProblem(random)), sent, false, random) ? 1 : 0;
    }
    EXPECT_GE(refused, kProblems * 3 / 4) << factor;
  }
}

// Both make the pose contradict gravity by 12 degrees.
TEST(LensSearch, TellsAPrincipalPointFromAWrongGravity) {
  Random random = TestRandom();
  SCOPED_TRACE(::testing::Message() << "seed " << TestSeed());
  const Camera camera = BarrelCamera(kFocalPx, kCentrePx);
  const Camera shifted =
      BarrelCamera(kFocalPx, kCentrePx + kFocalPx * Eigen::Vector2d(0.08, std::tan(kTurnRad)));
  int of_lens = 0;
  int of_gravity = 0;
  for (int i = 0; i < kProblems; ++i) {
    const PoseProblem problem = TrueProblem(random);
    of_lens += IsRefused(As(shifted, problem), shifted, true, random) ? 1 : 0;
    PoseProblem turned = As(camera, problem);
    turned.gravity_in_camera =
        Eigen::AngleAxisd(kTurnRad, Eigen::Vector3d::UnitX()) * turned.gravity_in_camera;
    of_gravity += IsRefused(turned, camera, true, random) ? 1 : 0;
  }
  // Half of them on average; none without the search for principal points.
  EXPECT_GE(of_lens, kProblems / 4);
  EXPECT_LE(of_gravity, 1);
}

TEST(LensSearch, APoseThatExplainsMostMatchesIsNotAskedAgain) {
  Random random = TestRandom();
  const Camera sent = BarrelCamera(kFocalPx, kCentrePx);
  PoseProblem problem = As(sent, TrueProblem(random));
  RefinedPose pose;  // far from the truth, so that any other lens would do better
  pose.point_inliers.assign(problem.points.size(), 1);
  EXPECT_FALSE(AgreesBetterThroughAnotherLens(problem, pose, sent, false, kThresholdPx));
  pose.point_inliers.assign(problem.points.size(), 0);
  EXPECT_TRUE(AgreesBetterThroughAnotherLens(problem, pose, sent, false, kThresholdPx));
}

}  // namespace
}  // namespace maploc::testing
