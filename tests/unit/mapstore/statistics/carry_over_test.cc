#include "mapstore/statistics/carry_over.h"

#include <gmock/gmock.h>

namespace maploc {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Eigen::Vector3d Place(LandmarkId number) { return {static_cast<double>(number), 2.0, -1.0}; }

// Landmarks at the places first ... last, with ids that differ by `id_offset`, moved by `by`.
SegmentLandmarks Landmarks(SegmentId segment, LandmarkId first, LandmarkId last,
                           LandmarkId id_offset = 0,
                           const Eigen::Vector3d& by = Eigen::Vector3d::Zero()) {
  SegmentLandmarks landmarks;
  landmarks.segment = segment;
  for (LandmarkId i = first; i <= last; ++i) {
    landmarks.ids.push_back(i + id_offset);
    landmarks.positions.push_back(Place(i) + by);
  }
  return landmarks;
}

TEST(CarryOver, OfTheSameMapIsTheIdentity) {
  const std::vector segments = {Landmarks(0, 0, 9), Landmarks(1, 10, 19)};
  EXPECT_THAT(CarryOver(segments, segments, 0.1),
              ElementsAre(CarriedShare{0, 0, 1.0}, CarriedShare{1, 1, 1.0}));
}

// The new version counts its landmarks anew and moved them by a little.
TEST(CarryOver, KnowsLandmarksByTheirPlaceAlone) {
  const std::vector old_segments = {Landmarks(0, 0, 9)};
  const Eigen::Vector3d little(0.03, -0.03, 0.03);
  EXPECT_THAT(CarryOver(old_segments, std::vector{Landmarks(4, 0, 9, 700, little)}, 0.1),
              ElementsAre(CarriedShare{0, 4, 1.0}));
  EXPECT_THAT(CarryOver(old_segments, std::vector{Landmarks(4, 0, 9, 700, 3.0 * little)}, 0.1),
              IsEmpty());
  EXPECT_THAT(CarryOver(old_segments, std::vector{Landmarks(4, 20, 29)}, 0.1), IsEmpty());
}

// However segments overlap: each knows what it knew, however often the map comes again.
TEST(CarryOver, OfTheSameOverlappingMapIsTheIdentity) {
  SegmentLandmarks at_one_place = Landmarks(5, 30, 33);
  for (Eigen::Vector3d& position : at_one_place.positions) position = Place(30);
  const std::vector segments = {Landmarks(0, 0, 9), Landmarks(1, 4, 14),  Landmarks(2, 6, 8),
                                Landmarks(3, 6, 8), Landmarks(4, 12, 13), at_one_place};
  EXPECT_THAT(
      CarryOver(segments, segments, 0.1),
      ElementsAre(CarriedShare{0, 0, 1.0}, CarriedShare{1, 1, 1.0}, CarriedShare{2, 2, 1.0},
                  CarriedShare{3, 3, 1.0}, CarriedShare{4, 4, 1.0}, CarriedShare{5, 5, 1.0}));
}

// Of segment 0's ten landmarks six are in new segment 0, four in new segment 1, of which two are in
// both: these count in the segment that shares more.
TEST(CarryOver, SharesInProportionToSharedLandmarks) {
  const std::vector old_segments = {Landmarks(0, 0, 9), Landmarks(1, 8, 15)};
  const std::vector new_segments = {Landmarks(0, 0, 5), Landmarks(1, 4, 7)};
  const auto shares = CarryOver(old_segments, new_segments, 0.1);
  ASSERT_EQ(shares.size(), 2u);
  EXPECT_EQ(shares[0].to, 0);
  EXPECT_DOUBLE_EQ(shares[0].weight, 0.6);
  EXPECT_EQ(shares[1].to, 1);
  EXPECT_DOUBLE_EQ(shares[1].weight, 0.2);
}

// Two old landmarks near one new one: only the nearest is the same.
TEST(CarryOver, PairsEachLandmarkOnce) {
  SegmentLandmarks old_segment = Landmarks(0, 0, 1);
  old_segment.positions[1] = Place(0) + Eigen::Vector3d(0.02, 0, 0);
  const auto shares = CarryOver(std::vector{old_segment}, std::vector{Landmarks(0, 0, 0)}, 0.1);
  ASSERT_EQ(shares.size(), 1u);
  EXPECT_DOUBLE_EQ(shares[0].weight, 0.5);
}

TEST(CarryOver, FarFromTheOriginAndWithoutToleranceToo) {
  const Eigen::Vector3d far(5e5, -4e6, 100.0);
  const std::vector segments = {Landmarks(0, 0, 9, 0, far)};
  EXPECT_THAT(CarryOver(segments, segments, 0.01), ElementsAre(CarriedShare{0, 0, 1.0}));
  EXPECT_THAT(CarryOver(segments, segments, 0.0), IsEmpty());
  EXPECT_THAT(CarryOver({}, segments, 0.1), IsEmpty());
}

SegmentSessionRow Row(SegmentId segment, std::int64_t localized) {
  SegmentSessionRow row;
  row.session = "s";
  row.session_start_unix_ns = 7;
  row.segment = segment;
  row.queries = localized + 3;
  row.localized = localized;
  row.point_matches = 100 * localized;
  row.point_inliers = 61 * localized;
  row.usable_line_matches = 11 * localized;
  row.usable_line_inliers = 11 * localized;
  row.median_point_matches = 100.0 + segment;
  row.median_usable_line_matches = 11.0;
  return row;
}

TEST(CarryRows, OfWholeSegmentsAreTheSameRows) {
  const std::vector rows = {Row(0, 5), Row(1, 20)};
  const auto carried = CarryRows(rows, std::vector<CarriedShare>{{0, 0, 1.0}, {1, 1, 1.0}});
  EXPECT_EQ(carried, rows);
}

TEST(CarryRows, AddUpAndRound) {
  const auto carried =
      CarryRows(std::vector{Row(0, 10), Row(1, 20)},
                std::vector<CarriedShare>{{0, 2, 0.5}, {1, 2, 0.25}, {1, 3, 0.01}});
  ASSERT_EQ(carried.size(), 1u);  // a hundredth of 20 queries and of 3 is none
  EXPECT_EQ(carried[0].segment, 2);
  EXPECT_EQ(carried[0].session, "s");
  EXPECT_EQ(carried[0].session_start_unix_ns, 7);
  EXPECT_EQ(carried[0].queries, 13);  // localized 5 + 5, failed 1.5 (rounded up) + 0.75
  EXPECT_EQ(carried[0].localized, 10);
  EXPECT_EQ(carried[0].point_matches, 1000);
  EXPECT_EQ(carried[0].point_inliers, 610);
  EXPECT_DOUBLE_EQ(carried[0].median_point_matches, 100.5);
  EXPECT_TRUE(CarryRows({}, {}).empty());
}

// Two halves of one query are one query, and its matches are where it is.
TEST(CarryRows, CountNothingTwice) {
  SegmentSessionRow row = Row(0, 1);
  row.queries = 1;
  const auto carried =
      CarryRows(std::vector{row}, std::vector<CarriedShare>{{0, 1, 0.5}, {0, 2, 0.5}});
  row.segment = 1;
  EXPECT_THAT(carried, ElementsAre(row));
}

TEST(CarryRows, NeverHaveMoreInliersThanMatches) {
  for (double weight = 0.01; weight <= 1.0; weight += 0.013) {
    for (const SegmentSessionRow& row :
         CarryRows(std::vector{Row(0, 3)}, std::vector<CarriedShare>{{0, 0, weight}})) {
      EXPECT_LE(row.localized, row.queries);
      EXPECT_LE(row.point_inliers, row.point_matches);
      EXPECT_LE(row.usable_line_inliers, row.usable_line_matches);
    }
  }
}

TEST(SharedLandmarkTolerance, IsAHundredthOfTheViewingDistance) {
  Segment segment;
  segment.path_in_map = {{0, 0, 0}, {10, 0, 0}};
  segment.points.ids = {1, 2, 3};
  segment.points.positions_in_map = {{0, 3, 0}, {10, 5, 0}, {10, 70, 0}};
  EXPECT_DOUBLE_EQ(SharedLandmarkTolerance(std::vector{segment}), 0.05);
  EXPECT_EQ(SharedLandmarkTolerance({}), 0.0);
}

}  // namespace
}  // namespace maploc
