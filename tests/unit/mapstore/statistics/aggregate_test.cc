#include <gtest/gtest.h>

#include "mapstore/statistics/statistics.h"
#include "tests/unit/mapstore/statistics/rows.h"

namespace maploc {
namespace {

using testing::Row;

// Changes alone discount, by nine tenths.
StatisticsOptions WithoutAgeing() {
  StatisticsOptions options;
  options.half_life_sessions = 1e300;
  options.change_discount = 0.1;
  return options;
}

TEST(Aggregate, OfNothingIsNothing) {
  EXPECT_EQ(Aggregate({}), SegmentStatistics{});
  EXPECT_FALSE(Aggregate({}).PointInlierRatio().has_value());
  EXPECT_FALSE(Aggregate({}).LineInlierRatio().has_value());
}

TEST(Aggregate, OfOneSessionIsThatSession) {
  const SegmentStatistics s = Aggregate(std::vector{Row(1, 4, 50, 0.6, 10, 0.3)});
  EXPECT_EQ(s.sessions, 1);
  EXPECT_EQ(s.queries, 4);
  EXPECT_EQ(s.point_matches, 200.0);
  EXPECT_EQ(s.point_inliers, 120.0);
  EXPECT_EQ(s.usable_line_matches, 40.0);
  EXPECT_EQ(s.usable_line_inliers, 12.0);
  EXPECT_EQ(s.typical_point_matches, 50.0);
  EXPECT_EQ(s.typical_usable_line_matches, 10.0);
}

// With a half-life of one session the weights are 1/4, 1/2, 1, whatever the time between them.
TEST(Aggregate, WeighsByRank) {
  StatisticsOptions options;
  options.half_life_sessions = 1.0;
  const SegmentStatistics s = Aggregate(
      std::vector{Row(1, 2, 100, 0.5), Row(2, 2, 60, 0.5), Row(1'000'000, 2, 40, 0.5)}, options);
  EXPECT_EQ(s.point_matches, 200 / 4.0 + 120 / 2.0 + 80);
  EXPECT_EQ(s.point_inliers, 100 / 4.0 + 60 / 2.0 + 40);
  EXPECT_DOUBLE_EQ(s.typical_point_matches, (100 / 4.0 + 60 / 2.0 + 40) / (1 / 4.0 + 1 / 2.0 + 1));
  EXPECT_EQ(s.sessions, 3);
  EXPECT_EQ(s.queries, 6);
}

TEST(Aggregate, ASessionWithManyQueriesSaysMoreAboutTheTypicalOne) {
  const StatisticsOptions options = WithoutAgeing();
  const SegmentStatistics s =
      Aggregate(std::vector{Row(1, 9, 100, 0.5), Row(2, 0, 0, 0.0), Row(3, 1, 200, 0.5)}, options);
  EXPECT_DOUBLE_EQ(s.typical_point_matches, 110.0);
}

// Old: 20 queries at 0.6, worth 200 independent matches; new: 20 queries. The 99.9% interval is
// 3.29 sqrt(m (1 - m) (1/200 + 1/200 + 0.02 (1 + 1))) = 3.29 sqrt(0.05 m (1 - m)), with m the mean
// of both: 0.366 for 0.234 (m = 0.417), 0.296 for 0.896 (m = 0.748).
TEST(Aggregate, AChangeDiscountsTheOlderSessionsAtOnce) {
  const StatisticsOptions options = WithoutAgeing();
  const SegmentSessionRow old = Row(1, 20, 100, 0.6);
  const SegmentStatistics within = Aggregate(std::vector{old, Row(2, 20, 100, 0.26)}, options);
  EXPECT_EQ(within.point_matches, 4000.0);
  const SegmentStatistics outside = Aggregate(std::vector{old, Row(2, 20, 100, 0.21)}, options);
  EXPECT_DOUBLE_EQ(outside.point_matches, 0.1 * 2000 + 2000);
  EXPECT_DOUBLE_EQ(outside.point_inliers, 0.1 * 1200 + 420);
  EXPECT_EQ(outside.queries, 40);  // plain counts stay
  const SegmentStatistics better = Aggregate(std::vector{old, Row(2, 20, 100, 0.93)}, options);
  EXPECT_DOUBLE_EQ(better.point_matches, 0.1 * 2000 + 2000);
}

// Forty sessions that differ as 0.5 and 0.7 do are no changes; nor is the next one at 0.35, which
// beside forty equal ones would be.
TEST(Aggregate, ScatterIsLearned) {
  const StatisticsOptions options = WithoutAgeing();
  std::vector<SegmentSessionRow> scattered;
  std::vector<SegmentSessionRow> equal;
  for (int i = 0; i < 40; ++i) {
    scattered.push_back(Row(i, 20, 100, i % 2 == 0 ? 0.5 : 0.7));
    equal.push_back(Row(i, 20, 100, 0.6));
  }
  scattered.push_back(Row(40, 20, 100, 0.35));
  equal.push_back(Row(40, 20, 100, 0.35));
  EXPECT_EQ(Aggregate(scattered, options).point_matches, 41 * 2000.0);
  EXPECT_DOUBLE_EQ(Aggregate(equal, options).point_matches, 0.1 * 40 * 2000 + 2000);
}

TEST(Aggregate, AChangeOfTheLinesAloneCountsToo) {
  const StatisticsOptions options = WithoutAgeing();
  const SegmentStatistics s =
      Aggregate(std::vector{Row(1, 20, 100, 0.6, 20, 0.7), Row(2, 20, 100, 0.6, 20, 0.2)}, options);
  EXPECT_DOUBLE_EQ(s.usable_line_matches, 0.1 * 400 + 400);
  EXPECT_DOUBLE_EQ(s.point_matches, 0.1 * 2000 + 2000);
}

// Two queries prove nothing, however many matches they have.
TEST(Aggregate, AShortOddSessionIsNoChange) {
  const StatisticsOptions options = WithoutAgeing();
  const SegmentStatistics s =
      Aggregate(std::vector{Row(1, 20, 100, 0.6), Row(2, 2, 1000, 0.4)}, options);
  EXPECT_EQ(s.point_matches, 4000.0);
}

// A record without an outlier must not make the first outlier a change.
TEST(Aggregate, ASpotlessRecordDoesNotPredictPerfection) {
  const StatisticsOptions options = WithoutAgeing();
  const SegmentStatistics s =
      Aggregate(std::vector{Row(1, 20, 100, 1.0), Row(2, 20, 100, 0.999)}, options);
  EXPECT_EQ(s.point_matches, 4000.0);
}

TEST(Aggregate, ASessionOfFailuresAloneChangesNoRatio) {
  SegmentSessionRow failed;
  failed.session = "failed";
  failed.session_start_unix_ns = 2;
  failed.queries = 30;
  const SegmentStatistics s = Aggregate(std::vector{Row(1, 4, 50, 0.6), failed});
  EXPECT_EQ(s.queries, 34);
  EXPECT_EQ(s.localized, 4);
  EXPECT_DOUBLE_EQ(*s.PointInlierRatio(), 0.6);
  EXPECT_DOUBLE_EQ(s.typical_point_matches, 50.0);
}

}  // namespace
}  // namespace maploc
