#include "tests/experiments/selection/second_pass.h"

#include <gtest/gtest.h>

#include "server/ransac/stopping.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::selection {
namespace {

constexpr SearchLimits kLimits = TrialOptions().long_search;

// What the others saw where the query is: nine in ten lines right.
StrategyDecision LinesExpected() {
  StrategyDecision decision;
  decision.strategy = Strategy::k1P1L;
  decision.source = StrategySource::kLearned;
  decision.predicted_success = 0.3;
  decision.ranking = {Strategy::k1P1L, Strategy::kMixed, Strategy::k2P};
  return decision;
}

PoseProblem Problem(int line_inliers, int line_outliers, int repetition = 0) {
  testing::SyntheticOptions options;
  options.point_inliers = 8;
  options.point_outliers = 112;
  options.line_inliers = line_inliers;
  options.line_outliers = line_outliers;
  Random random = testing::TestRandom(repetition);
  return testing::MakeSyntheticProblem(options, random).problem;
}

// That of SyntheticOptions.
Camera TestCamera() {
  return *Camera::Create(CameraModel::kSimplePinhole, 640, 480, {500.0, 320.0, 240.0});
}

TEST(SecondPassTest, HopelessStrategyCostsItsPatienceAndTheNextOnesIterations) {
  const StrategyDecision decision = LinesExpected();
  const int patience =
      Patience(decision.strategy, decision.predicted_success, kLimits.max_iterations);
  int given_up = 0;
  for (int i = 0; i < 10; ++i) {
    const PoseProblem problem = Problem(0, 40, i);
    const std::uint64_t seed = testing::TestSeed(i);
    const Attempt selected = TryAsDecided(problem, TestCamera(), decision, kLimits, seed);
    const Attempt next = TryStrategy(problem, Strategy::kMixed, kLimits, seed);
    EXPECT_TRUE(selected.camera_from_map.has_value());
    const bool told = selected.iterations == patience;  // local optimization was lucky
    EXPECT_TRUE(told || selected.iterations == patience + next.iterations) << selected.iterations;
    given_up += told ? 0 : 1;
  }
  EXPECT_GE(given_up, 5);
}

TEST(SecondPassTest, StrategyThatFindsCostsItsOwnIterationsAlone) {
  const PoseProblem problem = Problem(36, 4);
  const std::uint64_t seed = testing::TestSeed();
  const Attempt selected = TryAsDecided(problem, TestCamera(), LinesExpected(), kLimits, seed);
  const Attempt own = TryStrategy(problem, Strategy::k1P1L, kLimits, seed);
  ASSERT_TRUE(own.camera_from_map.has_value());
  EXPECT_EQ(selected.iterations, own.iterations);
}

TEST(SecondPassTest, StrategyThatCannotBeDrawnCostsNothing) {
  const PoseProblem problem = Problem(0, 0);
  const std::uint64_t seed = testing::TestSeed();
  const Attempt selected = TryAsDecided(problem, TestCamera(), LinesExpected(), kLimits, seed);
  EXPECT_TRUE(selected.camera_from_map.has_value());
  EXPECT_EQ(selected.iterations, TryStrategy(problem, Strategy::kMixed, kLimits, seed).iterations);
}

TEST(SecondPassTest, WithoutEvidenceTheSearchIsMixedToTheLimit) {
  const PoseProblem problem = Problem(0, 40);
  const std::uint64_t seed = testing::TestSeed();
  EXPECT_EQ(TryAsDecided(problem, TestCamera(), StrategyDecision(), kLimits, seed).iterations,
            TryStrategy(problem, Strategy::kMixed, kLimits, seed).iterations);
}

TEST(SecondPassTest, SessionIsSearchedByTheDecisionOfItsSegment) {
  SetQuery query;
  query.name = "query";
  query.query.views.push_back({TestCamera(), Rigid3(), {}, {}});
  QueryResult result;
  result.segment = 0;
  result.problem = Problem(0, 40);
  SessionResult session{"left out", {result, result}};
  session.queries[1].segment = -1;
  LeftOut left_out;
  left_out.segments[0].decision = LinesExpected();
  RunSecondPass({"left out", {query, query}}, left_out, TrialOptions(), session);
  const LongSearch selected = LongSearchOf(session.queries[0], kSelection);
  const LongSearch mixed = LongSearchOf(session.queries[0], AutoMethodOf(Strategy::kMixed));
  const int patience =
      Patience(Strategy::k1P1L, LinesExpected().predicted_success, kLimits.max_iterations);
  EXPECT_GE(selected.iterations, patience);
  EXPECT_LE(selected.iterations, patience + mixed.iterations);
  EXPECT_TRUE(selected.error.has_value());
  EXPECT_GT(selected.ms, 0.0);
  EXPECT_EQ(LongSearchOf(session.queries[1], kSelection).iterations, 0);  // out of the map
}

}  // namespace
}  // namespace maploc::selection
