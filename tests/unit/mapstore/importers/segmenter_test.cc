#include "mapstore/importers/segmenter.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapstore/importers/frame_order.h"
#include "tests/support/seed.h"
#include "tests/unit/mapstore/importers/drawn_scene.h"

namespace maploc {
namespace {

std::vector<KeyFrame> Walk(int count, double step) {
  std::vector<KeyFrame> frames;
  for (int i = 0; i < count; ++i) frames.push_back(testing::MakeFrame(i, {step * i, 0, 1}));
  return frames;
}

TEST(RecordedOrderTest, NumbersInNamesCountByValue) {
  std::vector<KeyFrame> frames = Walk(12, 1.0);
  std::reverse(frames.begin(), frames.end());
  EXPECT_THAT(RecordedOrder(frames),
              ::testing::Optional(::testing::ElementsAre(11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0)));
}

TEST(RecordedOrderTest, NamesWithoutOrderGiveWayToNearness) {
  std::vector<KeyFrame> frames = Walk(20, 1.0);
  std::vector<int> all;
  for (int i = 0; i < 20; ++i) {  // names jump across the whole walk
    frames[static_cast<std::size_t>(i)].name = "p" + std::to_string(i * 7 % 20) + ".jpg";
    all.push_back(i);
  }
  EXPECT_FALSE(RecordedOrder(frames));
  const std::vector<int> order = OrderByNearness(frames, all);
  for (std::size_t i = 1; i < order.size(); ++i) EXPECT_EQ(std::abs(order[i] - order[i - 1]), 1);
}

TEST(CutPathTest, CoversEveryFrameInOrderAndOverlaps) {
  Random random = testing::TestRandom();
  for (int repetition = 0; repetition < 50; ++repetition) {
    const int count = 1 + static_cast<int>(random.Below(60));
    std::vector<KeyFrame> frames;
    double x = 0;
    for (int i = 0; i < count; ++i) {
      x += random.Below(10) == 0 ? 30.0 : random.Uniform(0, 2);
      frames.push_back(testing::MakeFrame(i, {x, 0, 1}));
    }
    const auto segments = CutPath(frames, *RecordedOrder(frames), random.Uniform(0.5, 40));
    std::set<int> covered;
    for (std::size_t s = 0; s < segments.size(); ++s) {
      ASSERT_FALSE(segments[s].empty());
      for (std::size_t i = 1; i < segments[s].size(); ++i) {
        EXPECT_EQ(segments[s][i], segments[s][i - 1] + 1);
      }
      covered.insert(segments[s].begin(), segments[s].end());
      if (s == 0) continue;
      EXPECT_LT(segments[s].front(), segments[s - 1].back()) << "segments must overlap";
    }
    EXPECT_EQ(covered.size(), frames.size());
  }
}

TEST(CutPathTest, StandingStillOrNoLengthIsOneSegment) {
  const std::vector<KeyFrame> frames = Walk(5, 0.0);
  EXPECT_EQ(CutPath(frames, *RecordedOrder(frames), 10).size(), 1u);
  EXPECT_EQ(CutPath(Walk(5, 1.0), {0, 1, 2, 3, 4}, 0.0).size(), 1u);
  EXPECT_LE(CutPath(Walk(5, 1.0), {0, 1, 2, 3, 4}, 1e-300).size(), 5u);
}

TEST(SegmentMakerTest, SaysFromWhereALineWasSeen) {
  const std::vector<KeyFrame> frames = Walk(3, 1.0);
  const DescriptorKind kind = *DescriptorKindFromName("binary1");
  const std::vector<LineTrackInMap> lines = {{{{1, 4, 0}, {1, 4, 2}}, {1}, {7}}};
  const Segment segment = SegmentMaker(frames, {}, {lines, kind}).Make(0, {0, 1});
  ASSERT_EQ(segment.lines.viewing.size(), 1u);
  const ViewingRange& range = segment.lines.viewing[0];
  EXPECT_LT((range.toward_cameras_in_map - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6f);
  EXPECT_FLOAT_EQ(range.max_distance, 4.0f) << "from the middle of its segment";
}

TEST(SegmentMakerTest, HoldsWhatItsFramesSawUnderTheSameIds) {
  const std::vector<KeyFrame> frames = Walk(4, 1.0);
  const DescriptorKind kind = *DescriptorKindFromName("binary2");
  const std::vector<PointTrack> points = {
      {{1, 0, 0}, {0, 1}, {1, 1}}, {{2, 0, 0}, {3}, {2, 2}}, {{3, 0, 0}, {1, 2}, {3, 3, 4, 4}}};
  const Segment segment = SegmentMaker(frames, {points, kind}, {}).Make(5, {1, 2});
  EXPECT_EQ(segment.id, 5);
  EXPECT_THAT(segment.points.ids, ::testing::ElementsAre(0, 2));
  EXPECT_THAT(segment.points.descriptors.bytes, ::testing::ElementsAre(1, 1, 3, 3, 4, 4));
  EXPECT_THAT(segment.points.descriptor_landmark, ::testing::ElementsAre(0, 1, 1));
  EXPECT_EQ(segment.path_in_map.size(), 2u);
  ASSERT_EQ(segment.points.viewing.size(), 2u);
  EXPECT_FLOAT_EQ(segment.points.viewing[0].max_distance, std::sqrt(2.0f));  // also from frame 0
  EXPECT_FLOAT_EQ(segment.points.viewing[1].min_distance, std::sqrt(2.0f));
  MapInfo info;
  info.point_descriptor = kind;
  EXPECT_TRUE(ValidateSegment(info, segment).ok());
}

}  // namespace
}  // namespace maploc
