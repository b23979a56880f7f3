// A wrong pose given as right is the worst that can happen: chance must not pass for evidence, and
// truth with little of it must.
#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "server/ransac/estimator.h"
#include "server/trust/confidence.h"
#include "server/trust/judge.h"
#include "tests/support/moved_signs.h"
#include "tests/support/repeated_pattern.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Answer {
  double confidence = 0.0;
  bool localized = false;
  Rigid3 camera_from_map;
};

const Camera& ImageCamera() {
  static const Camera camera =
      Camera::Create(CameraModel::kSimplePinhole, 640, 480, {500, 319.5, 239.5}).value();
  return camera;
}

Answer Localize(const PoseProblem& problem, std::uint64_t seed, int max_iterations) {
  RansacOptions ransac;
  ransac.seed = seed;
  ransac.max_iterations = max_iterations;
  const Consensus consensus = EstimateConsensus(problem, ransac);
  Answer answer;
  if (!consensus.found) return answer;
  const RefinedPose pose = RefinePose(problem, consensus.camera_from_map, {});
  TrustOptions trust;
  trust.gravity_was_sent = true;
  trust.iterations = consensus.iterations;
  const Verdict verdict = JudgePose(problem, pose, ImageCamera(), trust);
  answer.confidence = verdict.confidence;
  answer.localized = verdict.outcome == Outcome::kLocalized;
  answer.camera_from_map = verdict.pose.camera_from_map;
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
    EXPECT_FALSE(answer.localized) << "query " << i;
    largest = std::max(largest, answer.confidence);
  }
  RecordProperty("largest_confidence", std::to_string(largest));
}

TEST(Trust, RepeatedPatternsAreNeverBelieved) {
  Random random = TestRandom();
  int believed = 0;
  for (int i = 0; i < 1000; ++i) {
    const int matches = 50 + static_cast<int>(random.Below(200));
    const double line_share = i % 3 == 0 ? 0.0 : random.Uniform(0.3, 0.8);
    const PoseProblem problem =
        MakeRepeatedPattern({.matches = matches, .line_share = line_share}, random);
    believed += Localize(problem, random.Next(), 300).localized ? 1 : 0;
  }
  EXPECT_EQ(believed, 0) << "of 1000";
}

// Signs up to 160 px wide, well beyond a clump's 64. Of 10,800 queries with signs up to 60 px 56
// were believed when every feature of a sign counted, and 1 is now.
TEST(Trust, MovedSignsAreHardlyEverBelieved) {
  Random random = TestRandom();
  int believed = 0;
  for (int i = 0; i < 2000; ++i) {
    MovedSignsOptions options;
    options.signs = 2 + static_cast<int>(random.Below(3));
    options.features = 5 + static_cast<int>(random.Below(11));
    options.radius_px = random.Uniform(8, 80);
    options.others = 10 + static_cast<int>(random.Below(50));
    const PoseProblem problem = MakeMovedSigns(options, random);
    believed += Localize(problem, random.Next(), 2000).localized ? 1 : 0;
  }
  EXPECT_LE(believed, 1) << "of 2000";
}

struct Believed {
  int queries = 0;
  int wrong = 0;
};

Believed CountBelieved(SyntheticOptions options, int trials) {
  Random random = TestRandom();
  Believed believed;
  for (int i = 0; i < trials; ++i) {
    options.scene = i % 2 == 0 ? Scene::kCube : Scene::kCorridor;
    options.gravity_noise_rad = options.gravity_sigma_rad = 1.0 * kDegree;
    const SyntheticProblem made = MakeSyntheticProblem(options, random);
    const Answer answer = Localize(made.problem, random.Next(), 10000);
    if (!answer.localized) continue;
    ++believed.queries;
    const PoseError error = ComparePoses(answer.camera_from_map, made.camera_from_map);
    believed.wrong += error.rotation_rad > 5.0 * kDegree || error.position > 1.0 ? 1 : 0;
  }
  return believed;
}

TEST(Trust, TruthWithFewInliersIsBelieved) {
  for (const int inliers : {8, 10, 12}) {
    const Believed believed =
        CountBelieved({.point_inliers = inliers, .point_outliers = 30 - inliers}, 200);
    EXPECT_GE(believed.queries, inliers >= 10 ? 190 : 160) << inliers << " of 30, 200 queries";
    EXPECT_EQ(believed.wrong, 0);
  }
}

// Wrong matches that take each other's features: every one of them is where some landmark is seen,
// and under the true pose this must not look like a repeated pattern.
TEST(Trust, TruthAmongExchangedMatchesIsBelieved) {
  const Believed believed = CountBelieved(
      {.outliers = Outliers::kWrongAssociations, .point_inliers = 12, .point_outliers = 18}, 200);
  EXPECT_GE(believed.queries, 180);
  EXPECT_EQ(believed.wrong, 0);
}

// A winter's pose: points are gone, lines have stayed. The bar is 90%, less three standard
// deviations.
TEST(Trust, PosesCarriedByLinesAreBelieved) {
  for (const double vertical_line_share : {0.0, 0.7}) {
    const Believed few = CountBelieved({.point_inliers = 5,
                                        .point_outliers = 45,
                                        .line_inliers = 15,
                                        .line_outliers = 15,
                                        .vertical_line_share = vertical_line_share},
                                       100);
    EXPECT_GE(few.queries, 81);
    EXPECT_EQ(few.wrong, 0);
  }
  const Believed many = CountBelieved(
      {.point_inliers = 8, .point_outliers = 392, .line_inliers = 30, .line_outliers = 70}, 100);
  EXPECT_GE(many.queries, 81);
  EXPECT_EQ(many.wrong, 0);
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
  ASSERT_EQ(std::count(refined.point_inliers.begin(), refined.point_inliers.end(), 1), 60)
      << "else there is nothing to disbelieve";
  ConfidenceOptions confidence;
  EXPECT_LT(PoseConfidence(made.problem, refined, confidence), 0.9);
}

}  // namespace
}  // namespace maploc::testing
