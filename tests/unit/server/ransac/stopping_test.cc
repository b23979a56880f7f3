#include "server/ransac/stopping.h"

#include <gtest/gtest.h>

namespace maploc::testing {
namespace {

// 100 points, 20 inliers; 40 usable lines, 10 inliers.
const InlierCounts kCounts = {100, 20, 40, 10, 0, 0};

TEST(DrawProbability, IsThePapersFormulaOfEachStrategy) {
  EXPECT_DOUBLE_EQ(DrawProbability(Strategy::k2P, kCounts), 0.2 * 19 / 99);
  EXPECT_DOUBLE_EQ(DrawProbability(Strategy::k1P1L, kCounts), 0.2 * 0.25);
  EXPECT_DOUBLE_EQ(DrawProbability(Strategy::kMixed, kCounts), 0.2 * 29 / 139);
  EXPECT_DOUBLE_EQ(DrawProbability(Strategy::kP3P, kCounts), 0.2 * 19 / 99 * 18 / 98);
}

TEST(DrawProbability, VerticalLinesCountInPairs) {
  InlierCounts counts = kCounts;
  counts.vertical_lines = 11;
  counts.vertical_line_inliers = 6;
  // A vertical line is drawn and good with 6/11, its partner good with 5/10.
  EXPECT_DOUBLE_EQ(DrawProbability(Strategy::k1P1L, counts), 0.2 * (10 + 6 * 0.5) / 51);
  EXPECT_DOUBLE_EQ(DrawProbability(Strategy::k2P, counts), 0.2 * 19 / 99);
}

TEST(DrawProbability, IsZeroWhereTheStrategyCannotBeDrawn) {
  EXPECT_EQ(DrawProbability(Strategy::k1P1L, {100, 20, 0, 0, 0, 0}), 0);
  EXPECT_EQ(DrawProbability(Strategy::k2P, {1, 1, 10, 10, 0, 0}), 0);
  EXPECT_EQ(DrawProbability(Strategy::k2P, {10, 0, 10, 10, 0, 0}), 0);
  EXPECT_EQ(DrawProbability(Strategy::kP3P, {2, 2, 0, 0, 0, 0}), 0);
}

TEST(RequiredIterations, IsTheGeometricLaw) {
  // 1 - (1 - 0.1)^n >= 0.99 for n = 43.7.
  EXPECT_EQ(RequiredIterations(0.1, 1.0, 0.99, 10000), 44);
  EXPECT_EQ(RequiredIterations(0.2, 0.5, 0.99, 10000), 44);
}

TEST(RequiredIterations, StaysWithinItsBounds) {
  EXPECT_EQ(RequiredIterations(0.0, 0.5, 0.99, 777), 777);
  EXPECT_EQ(RequiredIterations(1e-12, 0.5, 0.99, 777), 777);
  EXPECT_EQ(RequiredIterations(1.0, 1.0, 0.99, 777), 1);
}

TEST(Patience, IsSomeTimesWhatIsExpected) {
  // 1 - (1 - 0.01)^n >= 0.999 for n = 687.3; four times that.
  EXPECT_EQ(Patience(Strategy::k1P1L, 0.01, 100000), 2752);
  EXPECT_EQ(Patience(Strategy::k1P1L, 0.01, 1000), 1000);
  EXPECT_EQ(Patience(Strategy::k1P1L, 0.9, 100000), 200);
  EXPECT_EQ(Patience(Strategy::k1P1L, 0.9, 100), 100);
  EXPECT_EQ(Patience(Strategy::k1P1L, 0.0, 12345), 12345) << "nothing was expected";
  EXPECT_EQ(Patience(Strategy::kMixed, 0.9, 12345), 12345) << "mixed draws whatever there is";
  EXPECT_EQ(Patience(Strategy::k1P1L, 1e-9, 12345), 12345);
}

}  // namespace
}  // namespace maploc::testing
