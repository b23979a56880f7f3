// A wrong pose given as right is the worst that can happen: chance must not pass for evidence, and
// truth with little of it must.
#include <numbers>

#include <gtest/gtest.h>

#include "server/ransac/estimator.h"
#include "server/refinement/confidence.h"
#include "tests/support/repeated_pattern.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kBar = 0.99;

struct Answer {
  double confidence = 0.0;
  Rigid3 camera_from_map;
};

Answer Localize(const PoseProblem& problem, std::uint64_t seed, int max_iterations) {
  RansacOptions ransac;
  ransac.seed = seed;
  ransac.max_iterations = max_iterations;
  const Consensus consensus = EstimateConsensus(problem, ransac);
  Answer answer;
  if (!consensus.found) return answer;
  const RefinedPose pose = RefinePose(problem, consensus.camera_from_map, {});
  ConfidenceOptions confidence;
  confidence.iterations = consensus.iterations;
  answer.confidence = PoseConfidence(problem, pose, confidence);
  answer.camera_from_map = pose.camera_from_map;
  return answer;
}

SyntheticOptions OnlyWrong(Random& random) {
  SyntheticOptions options;
  options.scene = random.Below(2) == 0 ? Scene::kCube : Scene::kCorridor;
  options.point_inliers = 0;
  options.point_outliers = 20 + static_cast<int>(random.Below(180));
  options.line_outliers = random.Below(2) == 0 ? 0 : static_cast<int>(random.Below(60));
  options.vertical_line_share = random.Below(2) == 0 ? 0.0 : 0.8;
  options.gravity_sigma_rad = random.Uniform(0.1, 2.0) * kDegree;
  return options;
}

TEST(Trust, RandomMatchesAreNeverBelieved) {
  Random random = TestRandom();
  double largest = 0;
  for (int i = 0; i < 2000; ++i) {
    const SyntheticProblem made = MakeSyntheticProblem(OnlyWrong(random), random);
    const Answer answer = Localize(made.problem, random.Next(), 300);
    EXPECT_LT(answer.confidence, kBar) << "query " << i;
    largest = std::max(largest, answer.confidence);
  }
  RecordProperty("largest_confidence", std::to_string(largest));
}

TEST(Trust, RepeatedPatternsAreNeverBelieved) {
  Random random = TestRandom();
  int believed = 0;
  for (int i = 0; i < 1000; ++i) {
    const int matches = 50 + static_cast<int>(random.Below(200));
    const PoseProblem problem =
        MakeRepeatedPattern({.matches = matches, .line_share = i % 2 == 0 ? 0.0 : 0.4}, random);
    const double confidence = Localize(problem, random.Next(), 300).confidence;
    believed += confidence >= kBar ? 1 : 0;
  }
  EXPECT_EQ(believed, 0) << "of 1000";
}

TEST(Trust, TruthWithFewInliersIsBelieved) {
  Random random = TestRandom();
  for (const int inliers : {8, 10, 12}) {
    int believed = 0;
    int wrong = 0;
    for (int i = 0; i < 200; ++i) {
      SyntheticOptions options;
      options.scene = i % 2 == 0 ? Scene::kCube : Scene::kCorridor;
      options.point_inliers = inliers;
      options.point_outliers = 30 - inliers;
      options.gravity_noise_rad = options.gravity_sigma_rad = 1.0 * kDegree;
      const SyntheticProblem made = MakeSyntheticProblem(options, random);
      const Answer answer = Localize(made.problem, random.Next(), 10000);
      if (answer.confidence < kBar) continue;
      ++believed;
      const PoseError error = ComparePoses(answer.camera_from_map, made.camera_from_map);
      wrong += error.rotation_rad > 5.0 * kDegree || error.position > 1.0 ? 1 : 0;
    }
    EXPECT_GE(believed, inliers >= 10 ? 190 : 160) << inliers << " of 30, 200 queries";
    EXPECT_EQ(wrong, 0);
  }
}

// All map points project onto a dot when the camera is far enough away: no evidence at all.
TEST(Trust, ACameraAtInfinityIsNotBelieved) {
  Random random = TestRandom();
  SyntheticOptions options;
  options.point_inliers = 0;
  options.point_outliers = 60;
  SyntheticProblem made = MakeSyntheticProblem(options, random);
  for (auto& point : made.problem.points) {
    point.normalized = 0.002 * RandomDirection(random).head<2>();  // all within a pixel
  }
  Rigid3 far = made.camera_from_map;
  far.translation = Eigen::Vector3d(0, 0, 1e5);
  const RefinedPose refined = RefinePose(made.problem, far, {});
  ConfidenceOptions confidence;
  EXPECT_LT(PoseConfidence(made.problem, refined, confidence), 0.9);
}

}  // namespace
}  // namespace maploc::testing
