#include <gtest/gtest.h>

#include "mapstore/statistics/statistics.h"

namespace maploc {
namespace {

Observation Query(std::int64_t sequence, SegmentId segment, Outcome outcome, FeatureCounts points,
                  FeatureCounts usable = {}, FeatureCounts vertical = {}) {
  Observation observation;
  observation.sequence = sequence;
  observation.segment = segment;
  observation.outcome = outcome;
  observation.evidence.points = points;
  observation.evidence.usable_lines = usable;
  observation.evidence.vertical_lines = vertical;
  return observation;
}

Session Autumn() {
  Session session;
  session.id = "autumn";
  session.start_unix_ns = 77;
  return session;
}

TEST(FoldObservations, SumsLocalizedQueriesBySegment) {
  const std::vector<Observation> observations = {
      Query(1, 4, Outcome::kLocalized, {10, 8}, {6, 3}, {2, 1}),
      Query(2, 1, Outcome::kLocalized, {30, 5}),
      Query(3, 4, Outcome::kLocalized, {20, 10}, {4, 4}, {5, 0}),
  };
  const auto rows = FoldObservations(Autumn(), observations);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].segment, 1);
  const SegmentSessionRow& row = rows[1];
  EXPECT_EQ(row.segment, 4);
  EXPECT_EQ(row.session, "autumn");
  EXPECT_EQ(row.session_start_unix_ns, 77);
  EXPECT_EQ(row.queries, 2);
  EXPECT_EQ(row.localized, 2);
  EXPECT_EQ(row.point_matches, 30);
  EXPECT_EQ(row.point_inliers, 18);
  EXPECT_EQ(row.usable_line_matches, 10);
  EXPECT_EQ(row.usable_line_inliers, 7);
  EXPECT_EQ(row.vertical_line_matches, 7);
  EXPECT_EQ(row.vertical_line_inliers, 1);
  EXPECT_EQ(row.median_point_matches, 15.0);
  EXPECT_EQ(row.median_usable_line_matches, 5.0);
  EXPECT_EQ(row.median_vertical_line_matches, 3.5);
}

// Its matches were wrong, or it would not have failed: they would pull the ratios down.
TEST(FoldObservations, AFailedQueryCountsAsAQueryAlone) {
  for (const Outcome outcome : {Outcome::kTooFewMatches, Outcome::kNoConsensus,
                                Outcome::kLowConfidence, Outcome::kGravityInconsistent}) {
    const std::vector<Observation> observations = {
        Query(1, 0, Outcome::kLocalized, {10, 8}, {6, 3}),
        Query(2, 0, outcome, {500, 3}, {50, 0}, {10, 0})};
    const auto rows = FoldObservations(Autumn(), observations);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].queries, 2);
    EXPECT_EQ(rows[0].localized, 1);
    EXPECT_EQ(rows[0].point_matches, 10);
    EXPECT_EQ(rows[0].usable_line_matches, 6);
    EXPECT_EQ(rows[0].vertical_line_matches, 0);
    EXPECT_EQ(rows[0].median_point_matches, 10.0);
  }
}

TEST(FoldObservations, ASegmentWithFailuresAloneStillHasARow) {
  const auto rows =
      FoldObservations(Autumn(), std::vector{Query(1, 3, Outcome::kNoConsensus, {9, 1})});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].queries, 1);
  EXPECT_EQ(rows[0].localized, 0);
  EXPECT_EQ(rows[0].median_point_matches, 0.0);
}

TEST(FoldObservations, OutOfMapMakesNoRow) {
  EXPECT_TRUE(
      FoldObservations(Autumn(), std::vector{Query(1, -1, Outcome::kOutOfMap, {})}).empty());
  EXPECT_TRUE(FoldObservations(Autumn(), {}).empty());
}

}  // namespace
}  // namespace maploc
