#include "server/trust/confidence.h"

#include <gtest/gtest.h>

#include "server/trust/chance.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

TEST(LogBinomialTail, IsTheTail) {
  // P(Binomial(4, 1/2) >= 3) = 5/16, P(Binomial(10, 0.1) >= 1) = 1 - 0.9^10.
  EXPECT_NEAR(LogBinomialTail(4, 3, 0.5), std::log10(5.0 / 16), 1e-12);
  EXPECT_NEAR(LogBinomialTail(10, 1, 0.1), std::log10(1 - std::pow(0.9, 10)), 1e-12);
  EXPECT_EQ(LogBinomialTail(10, 0, 0.1), 0);
  EXPECT_NEAR(LogBinomialTail(10, 10, 0.1), -10, 1e-12);
  EXPECT_TRUE(std::isinf(LogBinomialTail(10, 11, 0.1)));
  EXPECT_NEAR(LogBinomialTail(2000, 500, 1e-4), -1513.3, 0.1) << "Stirling; and no underflow";
}

TEST(CombineLogPValues, IsFishersRule) {
  // P(U V <= x) = x (1 - ln x) for uniform U, V.
  const double x = 0.01 * 0.2;
  EXPECT_NEAR(CombineLogPValues(std::log10(0.01), std::log10(0.2)),
              std::log10(x * (1 - std::log(x))), 1e-12);
  EXPECT_EQ(CombineLogPValues(0, 0), 0);
}

TEST(SpreadArea, OfAUniformRectangleIsItsArea) {
  std::vector<Eigen::Vector2d> features;
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) features.push_back({i / 100.0, 2.0 * j / 100.0});
  }
  EXPECT_NEAR(SpreadArea(features), 2.0, 0.01);
  EXPECT_EQ(SpreadArea({{0, 0}, {1, 1}}), 0.0);
}

TEST(AgreeingByRepetition, LeavesOutExchangedFeaturesAndKeepsPatterns) {
  EXPECT_EQ(AgreeingByRepetition({}), 0);
  EXPECT_EQ(AgreeingByRepetition(std::vector<std::int64_t>(20, 1)), 0) << "exchanged";
  EXPECT_EQ(AgreeingByRepetition(std::vector<std::int64_t>(20, 4)), 80) << "each place four times";
  std::vector<std::int64_t> sparse(20, 0);
  sparse[3] = sparse[7] = sparse[11] = 1;
  EXPECT_EQ(AgreeingByRepetition(sparse), 3) << "too few to tell: the safe side";
}

// What a robot relies on: more false alarms never mean more confidence, and nothing is certain.
// Whether the values are right is measured (server/trust/MEASUREMENTS.md) and asked of whole
// queries (tests/property/estimator/trust_test.cc).
TEST(ConfidenceOf, FallsWithFalseAlarmsAndIsNeverCertain) {
  double last = 1.0;
  for (double log_alarms = -14; log_alarms < 5; log_alarms += 0.1) {
    const double confidence = ConfidenceOf(log_alarms);
    EXPECT_LE(confidence, last);
    EXPECT_GT(confidence, 0.0);
    EXPECT_LT(confidence, 1.0);
    last = confidence;
  }
  EXPECT_LT(ConfidenceOf(0.0), 0.9) << "one pose as good is expected by chance";
}

// Of the same matches and pose, what gravity supports and what it does not. The fewest inliers that
// suffice upright do not suffice without; twice as many do.
TEST(PoseConfidence, AsksMoreOfAPoseThatGravityDoesNotSupport) {
  constexpr double kBar = 0.99;
  Random random = TestRandom();
  const auto confidence = [&](int inliers, bool has_gravity) {
    SyntheticOptions options;
    options.point_inliers = inliers;
    options.point_outliers = 20;
    Random same = random;
    SyntheticProblem made = MakeSyntheticProblem(options, same);
    made.problem.has_gravity = has_gravity;
    const RefinedPose pose = RefinePose(made.problem, made.camera_from_map, {});
    return PoseConfidence(made.problem, pose, {});
  };
  int fewest = 3;
  while (fewest < 40 && confidence(fewest, true) < kBar) ++fewest;
  ASSERT_LT(fewest, 20);
  EXPECT_LT(confidence(fewest, false), kBar);
  EXPECT_GE(confidence(2 * fewest, false), kBar);
}

}  // namespace
}  // namespace maploc::testing
