#include "mapstore/statistics/selector.h"

#include <cmath>

#include <gmock/gmock.h>

namespace maploc {
namespace {

SegmentSessionRow Row(int start, int localized, int points, double lambda, int lines,
                      double gamma) {
  SegmentSessionRow row;
  row.session = "s" + std::to_string(start);
  row.session_start_unix_ns = start;
  row.queries = localized;
  row.localized = localized;
  row.point_matches = localized * points;
  row.point_inliers = std::lround(localized * points * lambda);
  row.usable_line_matches = localized * lines;
  row.usable_line_inliers = std::lround(localized * lines * gamma);
  row.median_point_matches = points;
  row.median_usable_line_matches = lines;
  return row;
}

TEST(SelectStrategy, IsMixedBeforeThereIsEvidence) {
  const StrategyDecision none = SelectStrategy({});
  EXPECT_EQ(none.strategy, Strategy::kMixed);
  EXPECT_EQ(none.source, StrategySource::kDefault);
  EXPECT_EQ(none.predicted_success, 0.0);
  const StrategyDecision nine = SelectStrategy(std::vector{Row(1, 9, 100, 0.2, 20, 0.9)});
  EXPECT_EQ(nine.strategy, Strategy::kMixed);
  EXPECT_EQ(nine.source, StrategySource::kDefault);
  EXPECT_THAT(nine.reason, ::testing::HasSubstr("9.0 of 10"));
  const StrategyDecision ten = SelectStrategy(std::vector{Row(1, 10, 100, 0.2, 20, 0.9)});
  EXPECT_EQ(ten.strategy, Strategy::k1P1L);
  EXPECT_EQ(ten.source, StrategySource::kLearned);
}

TEST(SelectStrategy, TakesLinesWhereTheyHoldAndPointsWhereTheyDo) {
  SelectorOptions options;
  options.yields = NoGates();
  const StrategyDecision walls =
      SelectStrategy(std::vector{Row(1, 50, 100, 0.2, 30, 0.7)}, options);
  EXPECT_EQ(walls.strategy, Strategy::k1P1L);
  EXPECT_NEAR(walls.predicted_success, 0.2 * 0.7, 0.01);
  const StrategyDecision trees =
      SelectStrategy(std::vector{Row(1, 50, 100, 0.5, 30, 0.1)}, options);
  EXPECT_EQ(trees.strategy, Strategy::k2P);
  EXPECT_NEAR(trees.predicted_success, 0.5 * 0.5, 0.02);
}

// Equal rates: the three hardly differ, and the safe one stays, but now by evidence.
TEST(SelectStrategy, StaysMixedWhereTheyHardlyDiffer) {
  const StrategyDecision even = SelectStrategy(std::vector{Row(1, 50, 100, 0.4, 40, 0.4)});
  EXPECT_EQ(even.strategy, Strategy::kMixed);
  EXPECT_EQ(even.source, StrategySource::kLearned);
  EXPECT_GT(even.predicted_success, 0.1);
}

TEST(SelectStrategy, ASegmentWithoutLinesIsNeverGivenThem) {
  const StrategyDecision bare = SelectStrategy(std::vector{Row(1, 50, 100, 0.4, 0, 0.0)});
  EXPECT_NE(bare.strategy, Strategy::k1P1L);
}

// The last session makes 1P1L better than 2P and than mixed by a tenth: not enough to leave either
// for it, and no reason to leave it. Which one is used depends on what was used before.
TEST(SelectStrategy, HysteresisRemembersWhereItCameFrom) {
  SelectorOptions options;
  options.statistics.half_life_sessions = 1e-3;  // the last session alone
  const SegmentSessionRow nearly = Row(9, 50, 100, 0.40, 200, 0.44);
  const auto after = [&](const SegmentSessionRow& first) {
    return SelectStrategy(std::vector{first, nearly}, options).strategy;
  };
  EXPECT_EQ(after(Row(1, 50, 100, 0.40, 200, 0.05)), Strategy::k2P);
  EXPECT_EQ(after(Row(1, 50, 100, 0.10, 200, 0.90)), Strategy::k1P1L);
  EXPECT_EQ(after(Row(1, 50, 100, 0.40, 200, 0.40)), Strategy::kMixed);
}

TEST(SelectStrategy, AnIterationsCostCounts) {
  SelectorOptions options;
  const std::vector rows = {Row(1, 50, 100, 0.4, 30, 0.6)};
  EXPECT_EQ(SelectStrategy(rows, options).strategy, Strategy::k1P1L);
  options.cost_1p1l = 3.0;
  EXPECT_NE(SelectStrategy(rows, options).strategy, Strategy::k1P1L);
}

// A new season is followed at the end of its first session, however long the old one was.
TEST(SelectStrategy, FollowsAChangeInOneSession) {
  std::vector<SegmentSessionRow> rows;
  for (int i = 0; i < 30; ++i) rows.push_back(Row(i, 30, 200, 0.6, 200, 0.3));
  EXPECT_EQ(SelectStrategy(rows).strategy, Strategy::k2P);
  rows.push_back(Row(30, 30, 200, 0.1, 200, 0.5));
  EXPECT_EQ(SelectStrategy(rows).strategy, Strategy::k1P1L);
}

// A few lines among many points: mixed draws nearly always two points, so it is as good as 2P.
TEST(SelectStrategy, HasNoReasonToLeaveMixedForAFewBadLines) {
  EXPECT_EQ(SelectStrategy(std::vector{Row(1, 50, 1000, 0.4, 100, 0.05)}).strategy,
            Strategy::kMixed);
}

TEST(SelectStrategy, IsMixedWhereNothingCanSucceed) {
  SelectorOptions options;
  options.prior_matches = 0.0;
  EXPECT_EQ(SelectStrategy(std::vector{Row(1, 20, 10, 0.0, 5, 0.0)}, options).strategy,
            Strategy::kMixed);
}

}  // namespace
}  // namespace maploc
