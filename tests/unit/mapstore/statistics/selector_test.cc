#include "mapstore/statistics/selector.h"

#include <gmock/gmock.h>

#include "tests/unit/mapstore/statistics/rows.h"

namespace maploc {
namespace {

using testing::Row;

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

// Nobody is found any more: what the old sessions said about the rates no longer counts.
TEST(SelectStrategy, ForgetsARecordThatNoLongerHolds) {
  std::vector<SegmentSessionRow> rows;
  for (int i = 0; i < 20; ++i) rows.push_back(Row(i, 40, 120, 0.6, 120, 0.3));
  ASSERT_EQ(SelectStrategy(rows).strategy, Strategy::k2P);
  for (int i = 20; i < 23; ++i) {
    SegmentSessionRow failed;
    failed.session = "s" + std::to_string(i);
    failed.session_start_unix_ns = i;
    failed.queries = 40;
    rows.push_back(failed);
  }
  const StrategyDecision decision = SelectStrategy(rows);
  EXPECT_EQ(decision.strategy, Strategy::kMixed);
  EXPECT_EQ(decision.source, StrategySource::kDefault);
}

// Before the first session, with too little evidence, with enough, and when it no longer holds.
TEST(SelectorFold, PredictsFromTheRowsSoFarAtEveryStep) {
  SegmentSessionRow failed;
  failed.queries = 400;
  SelectorFold fold({});
  const auto expect_current = [&](const char* when) {
    const StrategyPrediction anew = PredictStrategies(fold.statistics().Value());
    for (const Strategy strategy : kSelectableStrategies) {
      EXPECT_EQ(fold.prediction().Of(strategy).expected_time, anew.Of(strategy).expected_time)
          << when << ", " << StrategyName(strategy);
    }
  };
  expect_current("no session");
  fold.Add(Row(1, 5, 120, 0.6, 120, 0.3));
  EXPECT_FALSE(fold.HasEvidence());
  expect_current("too little");
  fold.Add(Row(2, 40, 120, 0.6, 120, 0.3));
  EXPECT_TRUE(fold.HasEvidence());
  expect_current("enough");
  failed.session = "s3";
  failed.session_start_unix_ns = 3;
  fold.Add(failed);
  EXPECT_FALSE(fold.HasEvidence());
  expect_current("no longer");
}

TEST(SelectStrategy, RanksTheOthersBestFirstBehindTheOneInForce) {
  const auto walls = SelectStrategy(std::vector{Row(1, 50, 100, 0.2, 30, 0.7)}).ranking;
  EXPECT_THAT(walls, ::testing::ElementsAre(Strategy::k1P1L, Strategy::kMixed, Strategy::k2P));
  const auto trees = SelectStrategy(std::vector{Row(1, 50, 100, 0.5, 60, 0.1)}).ranking;
  EXPECT_THAT(trees, ::testing::ElementsAre(Strategy::k2P, Strategy::kMixed, Strategy::k1P1L));
  const auto none = SelectStrategy({}).ranking;
  EXPECT_EQ(none.front(), Strategy::kMixed);
}

// gamma >= lambda: 1P1L, else 2P, whatever the costs and probabilities.
TEST(SelectStrategy, FollowsThePapersRuleByConfiguration) {
  SelectorOptions paper;
  paper.criterion = StrategyCriterion::kPaper;
  paper.cost_1p1l = 100.0;
  const auto select = [&](double lambda, double gamma, int lines) {
    return SelectStrategy(std::vector{Row(1, 50, 100, lambda, lines, gamma)}, paper).strategy;
  };
  EXPECT_EQ(select(0.3, 0.4, 30), Strategy::k1P1L);
  EXPECT_EQ(select(0.4, 0.3, 30), Strategy::k2P);
  EXPECT_EQ(select(0.4, 0.9, 0), Strategy::k2P);  // no lines, no 1P1L
}

TEST(SelectStrategy, ThePapersRuleHasHysteresisToo) {
  SelectorOptions paper;
  paper.criterion = StrategyCriterion::kPaper;
  paper.statistics.half_life_sessions = 1e-3;  // the last session alone
  const auto after = [&](double first_gamma, double gamma) {
    return SelectStrategy(
               std::vector{Row(1, 50, 100, 0.4, 40, first_gamma), Row(2, 50, 100, 0.4, 40, gamma)},
               paper)
        .strategy;
  };
  EXPECT_EQ(after(0.7, 0.37), Strategy::k1P1L);
  EXPECT_EQ(after(0.1, 0.43), Strategy::k2P);
  EXPECT_EQ(after(0.7, 0.2), Strategy::k2P);
  EXPECT_EQ(after(0.1, 0.7), Strategy::k1P1L);
}

// Vertical lines, drawn in pairs, serve 1P1L where a segment has hardly any other.
TEST(SelectStrategy, CountsOnVerticalLinesWhereTheyAreDrawn) {
  SegmentSessionRow row = Row(1, 50, 100, 0.1, 2, 0.5);
  row.vertical_line_matches = 50 * 60;
  row.vertical_line_inliers = 50 * 36;
  row.median_vertical_line_matches = 60;
  EXPECT_EQ(SelectStrategy(std::vector{row}).strategy, Strategy::k1P1L);
  row.vertical_line_inliers = 50 * 3;
  EXPECT_EQ(SelectStrategy(std::vector{row}).strategy, Strategy::k2P);
}

TEST(ListSwitches, TellsEachChangeWithItsReason) {
  std::vector<SegmentSessionRow> rows;
  for (int i = 0; i < 10; ++i) rows.push_back(Row(i, 40, 120, 0.6, 120, 0.3));
  for (int i = 10; i < 13; ++i) rows.push_back(Row(i, 40, 120, 0.05, 120, 0.3));
  const auto switches = ListSwitches(rows);
  ASSERT_EQ(switches.size(), 2u);
  EXPECT_EQ(switches[0].session, "s0");
  EXPECT_EQ(switches[0].before, Strategy::kMixed);
  EXPECT_EQ(switches[0].after.strategy, Strategy::k2P);
  EXPECT_EQ(switches[1].before, Strategy::k2P);
  EXPECT_EQ(switches[1].after.strategy, Strategy::k1P1L);
  EXPECT_GE(switches[1].session_start_unix_ns, 10);
  EXPECT_THAT(switches[1].after.reason, ::testing::HasSubstr("1p1l instead of 2p"));
}

}  // namespace
}  // namespace maploc
