#include "mapstore/statistics/probabilities.h"

#include <gtest/gtest.h>

namespace maploc {
namespace {

// 10 points of which 5 are right, 5 lines of which 2 are right.
TEST(DrawProbabilities, AreThoseOfThePaper) {
  const StrategyValues draw = DrawProbabilities({10, 5, 0}, {0.5, 0.4, 0.0});
  EXPECT_DOUBLE_EQ(draw.p1p1l, 0.5 * 0.4);
  EXPECT_DOUBLE_EQ(draw.p2p, 0.5 * 4.0 / 9.0);
  EXPECT_DOUBLE_EQ(draw.mixed, 0.5 * 6.0 / 14.0);
}

TEST(DrawProbabilities, AreZeroForWhatCannotBeDrawn) {
  const StrategyValues no_line = DrawProbabilities({10, 0, 1}, {0.5, 0.9, 0.9});
  EXPECT_EQ(no_line.p1p1l, 0.0);
  EXPECT_DOUBLE_EQ(no_line.mixed, no_line.p2p);
  const StrategyValues one_point = DrawProbabilities({1, 4, 0}, {1.0, 0.5, 0.0});
  EXPECT_EQ(one_point.p2p, 0.0);
  EXPECT_DOUBLE_EQ(one_point.p1p1l, 0.5);
  EXPECT_DOUBLE_EQ(one_point.mixed, 0.5);
  const StrategyValues no_point = DrawProbabilities({0, 9, 9}, {0.5, 0.9, 0.9});
  EXPECT_EQ(no_point.p1p1l + no_point.p2p + no_point.mixed, 0.0);
  const StrategyValues lonely = DrawProbabilities({1, 0, 0}, {1.0, 1.0, 1.0});
  EXPECT_EQ(lonely.p1p1l + lonely.p2p + lonely.mixed, 0.0);
  // A mean over queries of half a line: most of them have none.
  const StrategyValues half = DrawProbabilities({10, 0.5, 0}, {0.5, 0.9, 0.0});
  EXPECT_EQ(half.p1p1l, 0.0);
}

// Less than two right points: a pair of right ones cannot be drawn, and no probability is negative.
TEST(DrawProbabilities, AreNeverNegative) {
  const StrategyValues draw = DrawProbabilities({10, 3, 4}, {0.05, 0.0, 0.1});
  EXPECT_EQ(draw.p2p, 0.0);
  EXPECT_EQ(draw.mixed, 0.0);
  EXPECT_EQ(draw.p1p1l, 0.0);
}

TEST(DrawProbabilities, AreOneWhereEverythingIsRight) {
  for (const double vertical : {0.0, 8.0}) {
    const StrategyValues draw = DrawProbabilities({7, 3, vertical}, {1.0, 1.0, 1.0});
    EXPECT_DOUBLE_EQ(draw.p1p1l, 1.0);
    EXPECT_DOUBLE_EQ(draw.p2p, 1.0);
    EXPECT_DOUBLE_EQ(draw.mixed, 1.0);
  }
}

// 4 vertical lines of which 3 are right, 2 usable ones of which 1 is right, 5 points of which 2.
// A vertical line is drawn with another one: 3/4 x 2/3 of the pairs are right, and of the draws of
// a vertical line three in four are of two different ones.
TEST(DrawProbabilities, TakeVerticalLinesInPairsWhereTheyOutnumberTheUsable) {
  const MatchCounts counts = {5, 2, 4};
  EXPECT_TRUE(DrawsVerticalLines(Strategy::k1P1L, counts));
  const StrategyValues draw = DrawProbabilities(counts, {0.4, 0.5, 0.75});
  EXPECT_DOUBLE_EQ(draw.p1p1l, 0.4 * (1.0 + 3.0 * 0.5) / (2.0 + 3.0));
  EXPECT_DOUBLE_EQ(draw.mixed, 0.4 * (1.0 + 1.0 + 1.5) / (4.0 + 2.0 + 3.0));
  EXPECT_DOUBLE_EQ(draw.p2p, 0.4 * 0.25);
}

TEST(DrawProbabilities, LeaveVerticalLinesAloneWhereTheyDoNotOutnumber) {
  for (const MatchCounts& counts : {MatchCounts{5, 4, 4}, MatchCounts{5, 0, 1}}) {
    EXPECT_FALSE(DrawsVerticalLines(Strategy::kMixed, counts));
    const StrategyValues with = DrawProbabilities(counts, {0.4, 0.5, 0.75});
    const StrategyValues without =
        DrawProbabilities({counts.points, counts.usable_lines, 0}, {0.4, 0.5, 0.0});
    EXPECT_EQ(with.p1p1l, without.p1p1l);
    EXPECT_EQ(with.mixed, without.mixed);
  }
}

// 1P1L leaves them alone where there are enough usable ones; mixed does not.
TEST(DrawProbabilities, TakeVerticalLinesByStrategy) {
  const StrategyValues draw = DrawProbabilities({5, 12, 20}, {0.4, 0.5, 0.75});
  EXPECT_DOUBLE_EQ(draw.p1p1l, 0.4 * 0.5);
  EXPECT_DOUBLE_EQ(draw.mixed, 0.4 * (1.0 + 6.0 + 19.0 * 0.75 * 14.0 / 19.0) / (4.0 + 12.0 + 19.0));
}

// A quarter of the draws is all inliers and half of these lead to the pose; of the others a third
// is evaluated.
TEST(IterationProbabilities, AreSharesOfTheEvaluatedDraws) {
  SampleYields yields = NoGates();
  yields.point_and_line = {0.5, 1.0 / 3.0};
  const StrategyValues iteration = IterationProbabilities({10, 10, 0}, {0.5, 0.5, 0.0}, yields);
  EXPECT_DOUBLE_EQ(iteration.p1p1l, 0.125 / (0.125 + 0.25));
  EXPECT_DOUBLE_EQ(iteration.p2p, 0.5 * 4.0 / 9.0);
  // mixed: 9 second points at 4/9, 10 lines at 1/2, each behind a point at 1/2.
  EXPECT_DOUBLE_EQ(iteration.mixed, (2.0 + 2.5 * 0.5) / (2.0 + 7.0 + 2.5 * 0.5 + 7.5 / 3.0));
}

}  // namespace
}  // namespace maploc
