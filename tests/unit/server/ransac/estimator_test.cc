#include "server/ransac/estimator.h"

#include <future>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

SyntheticOptions HalfWrong() {
  SyntheticOptions options;
  options.point_inliers = 60;
  options.point_outliers = 60;
  options.line_inliers = 20;
  options.line_outliers = 20;
  options.gravity_noise_rad = options.gravity_sigma_rad = 0.5 * kDegree;
  return options;
}

class EveryStrategy : public ::testing::TestWithParam<Strategy> {};

TEST_P(EveryStrategy, FindsThePoseAndItsInliers) {
  Random random = TestRandom();
  for (int i = 0; i < 50; ++i) {
    const SyntheticProblem made = MakeSyntheticProblem(HalfWrong(), random);
    RansacOptions options;
    options.strategy = GetParam();
    options.fall_back = false;
    options.seed = random.Next();
    const Consensus found = EstimateConsensus(made.problem, options);
    ASSERT_TRUE(found.found);
    EXPECT_FALSE(found.fell_back);
    EXPECT_EQ(found.strategy, GetParam());
    EXPECT_LT(found.iterations, options.max_iterations);
    const PoseError error = ComparePoses(found.camera_from_map, made.camera_from_map);
    EXPECT_LT(error.rotation_rad, 1.0 * kDegree);
    EXPECT_LT(error.position, 0.1);
    int missed = 0;
    for (std::size_t k = 0; k < made.problem.points.size(); ++k) {
      missed += made.point_is_inlier[k] == 1 && found.point_inliers[k] == 0 ? 1 : 0;
    }
    EXPECT_LE(missed, 6) << "of 60";
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryStrategy,
                         ::testing::Values(Strategy::k1P1L, Strategy::k2P, Strategy::kMixed,
                                           Strategy::kP3P),
                         [](const auto& param) {
                           return "Strategy" + std::string(StrategyName(param.param));
                         });

TEST(Estimator, OneSeedOneAnswer) {
  Random random = TestRandom();
  const SyntheticProblem made = MakeSyntheticProblem(HalfWrong(), random);
  RansacOptions options;
  options.seed = 7;
  const Consensus a = EstimateConsensus(made.problem, options);
  const Consensus b = EstimateConsensus(made.problem, options);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.score, b.score);
  EXPECT_EQ(a.point_inliers, b.point_inliers);
  EXPECT_TRUE(a.camera_from_map.rotation.coeffs() == b.camera_from_map.rotation.coeffs());
  EXPECT_TRUE(a.camera_from_map.translation == b.camera_from_map.translation);
}

TEST(Estimator, OneSeedOneAnswerOnAnyNumberOfThreads) {
  Random random = TestRandom();
  const SyntheticProblem made = MakeSyntheticProblem(HalfWrong(), random);
  const Consensus alone = EstimateConsensus(made.problem, {});
  std::vector<std::future<Consensus>> others;
  for (int i = 0; i < 8; ++i) {
    others.push_back(
        std::async(std::launch::async, [&] { return EstimateConsensus(made.problem, {}); }));
  }
  for (auto& other : others) {
    const Consensus found = other.get();
    EXPECT_EQ(found.iterations, alone.iterations);
    EXPECT_EQ(found.score, alone.score);
    EXPECT_EQ(found.line_inliers, alone.line_inliers);
    EXPECT_TRUE(found.camera_from_map.translation == alone.camera_from_map.translation);
  }
}

TEST(Estimator, AMapFarFromItsOriginIsNoOther) {
  Random random = TestRandom();
  const Eigen::Vector3d away(4e5, -3e5, 200);
  for (int i = 0; i < 20; ++i) {
    const SyntheticProblem made = MovedBy(away, MakeSyntheticProblem(HalfWrong(), random));
    const Consensus found = EstimateConsensus(made.problem, {});
    ASSERT_TRUE(found.found);
    EXPECT_LT(ComparePoses(found.camera_from_map, made.camera_from_map).position, 0.1);
  }
}

SyntheticProblem WithoutLines(Random& random) {
  SyntheticOptions options = HalfWrong();
  options.line_inliers = options.line_outliers = 0;
  return MakeSyntheticProblem(options, random);
}

TEST(Estimator, FallsBackWhereTheStrategyCannotBeDrawn) {
  Random random = TestRandom();
  const SyntheticProblem made = WithoutLines(random);
  RansacOptions options;
  options.strategy = Strategy::k1P1L;
  Consensus found = EstimateConsensus(made.problem, options);
  EXPECT_TRUE(found.found);
  EXPECT_TRUE(found.fell_back);
  EXPECT_EQ(found.strategy, Strategy::kMixed);
  options.fall_back = false;
  found = EstimateConsensus(made.problem, options);
  EXPECT_FALSE(found.found);
  EXPECT_EQ(found.iterations, 0);
}

TEST(Estimator, FallsBackInTheOrderAskedFor) {
  Random random = TestRandom();
  const SyntheticProblem made = WithoutLines(random);
  RansacOptions options;
  options.strategy = Strategy::k1P1L;
  options.fallbacks = {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed};
  const Consensus found = EstimateConsensus(made.problem, options);
  EXPECT_TRUE(found.found);
  EXPECT_TRUE(found.fell_back);
  EXPECT_EQ(found.strategy, Strategy::k2P);
}

TEST(Estimator, NothingToDrawIsNotFound) {
  PoseProblem problem;
  problem.focal_length_px = 500;
  const Consensus nothing = EstimateConsensus(problem, {});
  EXPECT_FALSE(nothing.found);
  EXPECT_EQ(nothing.iterations, 0);
  problem.points.resize(1);
  EXPECT_FALSE(EstimateConsensus(problem, {}).found);
  problem.points.resize(2);  // two equal points at the origin: every draw is degenerate
  RansacOptions options;
  options.max_iterations = 50;
  EXPECT_FALSE(EstimateConsensus(problem, options).found);
}

TEST(Estimator, WithoutGravityOnlyP3pAnswers) {
  Random random = TestRandom();
  SyntheticProblem made = MakeSyntheticProblem(HalfWrong(), random);
  made.problem.has_gravity = false;
  made.problem.gravity_in_camera.setZero();
  RansacOptions options;
  EXPECT_FALSE(EstimateConsensus(made.problem, options).found);
  options.strategy = Strategy::kP3P;
  const Consensus found = EstimateConsensus(made.problem, options);
  ASSERT_TRUE(found.found);
  EXPECT_LT(ComparePoses(found.camera_from_map, made.camera_from_map).position, 0.1);
}

// No pose to find: the search would run to its last iteration.
SyntheticProblem Hopeless(Random& random) {
  SyntheticOptions options;
  options.point_inliers = 0;
  options.point_outliers = 2000;
  return MakeSyntheticProblem(options, random);
}

TEST(Estimator, StopsAtItsDeadline) {
  Random random = TestRandom();
  const SyntheticProblem made = Hopeless(random);
  RansacOptions options;
  options.max_iterations = 100000000;
  const auto start = std::chrono::steady_clock::now();
  options.deadline = start + std::chrono::milliseconds(20);
  const Consensus found = EstimateConsensus(made.problem, options);
  EXPECT_TRUE(found.interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(Estimator, StopsWhenCancelled) {
  Random random = TestRandom();
  const SyntheticProblem made = Hopeless(random);
  const std::atomic<bool> cancelled = true;
  RansacOptions options;
  options.max_iterations = 100000000;
  options.cancelled = &cancelled;
  const Consensus found = EstimateConsensus(made.problem, options);
  EXPECT_TRUE(found.interrupted);
  EXPECT_EQ(found.iterations, 0);
}

}  // namespace
}  // namespace maploc::testing
