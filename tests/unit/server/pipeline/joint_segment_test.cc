#include "server/pipeline/joint_segment.h"

#include <algorithm>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "server/matching/joint_matching.h"
#include "server/pipeline/localizer.h"
#include "tests/support/drawn_world.h"
#include "tests/support/resident_map.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using testing::DrawnWorld;
using Segments = std::vector<std::shared_ptr<const Segment>>;

template <typename Landmarks>
std::set<LandmarkId> AllIds(const Segments& segments, Landmarks Segment::*kind) {
  std::set<LandmarkId> ids;
  for (const auto& segment : segments) {
    ids.insert(((*segment).*kind).ids.begin(), ((*segment).*kind).ids.end());
  }
  return ids;
}

TEST(JoinSegmentsTest, HoldsEachLandmarkOnceAsItsSegmentDoes) {
  const DrawnWorld world(testing::TestRandom());
  const Segment joint = JoinSegments(world.segments());
  EXPECT_TRUE(ValidateSegment(world.info(), joint).ok());
  const std::set<LandmarkId> points = AllIds(world.segments(), &Segment::points);
  const std::set<LandmarkId> lines = AllIds(world.segments(), &Segment::lines);
  EXPECT_TRUE(
      std::equal(points.begin(), points.end(), joint.points.ids.begin(), joint.points.ids.end()));
  EXPECT_TRUE(
      std::equal(lines.begin(), lines.end(), joint.lines.ids.begin(), joint.lines.ids.end()));
  // The last segment's landmarks keep what they were.
  const PointLandmarks& part = world.segments().back()->points;
  for (int landmark = 0; landmark < part.size(); ++landmark) {
    const auto place = static_cast<std::int32_t>(
        std::lower_bound(joint.points.ids.begin(), joint.points.ids.end(), part.ids[landmark]) -
        joint.points.ids.begin());
    EXPECT_EQ(joint.points.positions_in_map[place], part.positions_in_map[landmark]);
    const auto rows = [](const PointLandmarks& all, std::int32_t of) {
      return std::count(all.descriptor_landmark.begin(), all.descriptor_landmark.end(), of);
    };
    EXPECT_EQ(rows(joint.points, place), rows(part, landmark));
  }
}

TEST(JoinSegmentsTest, OfOneIsThatOne) {
  const DrawnWorld world(testing::TestRandom());
  const Segment& only = *world.segments()[1];
  const Segment joint = JoinSegments({world.segments()[1]});
  EXPECT_EQ(joint.id, only.id);
  EXPECT_EQ(joint.points.ids, only.points.ids);
  EXPECT_EQ(joint.points.descriptors.bytes, only.points.descriptors.bytes);
  EXPECT_EQ(joint.lines.descriptor_landmark, only.lines.descriptor_landmark);
}

std::shared_ptr<Segment> PointsSeenFrom(std::vector<LandmarkId> ids, float distance) {
  auto segment = std::make_shared<Segment>();
  segment->points.positions_in_map.resize(ids.size());
  segment->points.viewing.assign(ids.size(), {{0, 0, 1}, 0.5f, distance, distance});
  segment->points.ids = std::move(ids);
  return segment;
}

TEST(JoinSegmentsTest, TellsFromWhereLandmarksWereSeenWhereAllPartsKnowIt) {
  const auto left = PointsSeenFrom({1, 2}, 3.0f);
  const auto right = PointsSeenFrom({2, 5}, 4.0f);
  const Segment joint = JoinSegments({left, right, std::make_shared<Segment>()});
  ASSERT_EQ(joint.points.viewing.size(), 3u);
  EXPECT_EQ(joint.points.viewing[1], left->points.viewing[1]) << "the first one that holds it";
  EXPECT_EQ(joint.points.viewing[2], right->points.viewing[1]);

  right->points.viewing.clear();
  const Segment half_known = JoinSegments({left, right});
  EXPECT_TRUE(half_known.points.viewing.empty());
}

std::vector<std::tuple<int, int, float>> Tuples(const std::vector<FeatureMatch>& matches) {
  std::vector<std::tuple<int, int, float>> tuples;
  for (const auto& [feature, landmark, ratio] : matches) {
    tuples.emplace_back(feature, landmark, ratio);
  }
  return tuples;
}

// Searching each part and joining what was found, as the localizer does, is searching the joint
// segment: many landmarks are in several parts.
TEST(MatchJointlyTest, FindsWhatASearchOfTheJointSegmentFinds) {
  Random random = testing::TestRandom();
  for (int i = 0; i < 10; ++i) {
    const DrawnWorld world(testing::TestRandom(static_cast<std::uint64_t>(i)));
    const Query query = world.See(DrawnWorld::CameraFromMapAt(16.0, 0.6), {}, random);
    const View& view = query.views.front();
    const Segment joint = JoinSegments(world.segments());
    std::vector<SegmentSearch> searches;
    for (const auto& segment : world.segments()) searches.push_back(SearchSegment(view, *segment));
    std::vector<SearchedSegment> parts;
    for (std::size_t s = 0; s < searches.size(); ++s) {
      parts.push_back({world.segments()[s].get(), &searches[s]});
    }
    const Matches found = MatchJointly(parts, joint);
    const Matches expected = MatchSegment(view, joint);
    ASSERT_GT(expected.points.size(), 20u);
    ASSERT_GT(expected.lines.size(), 5u);
    EXPECT_EQ(Tuples(found.points), Tuples(expected.points));
    EXPECT_EQ(Tuples(found.lines), Tuples(expected.lines));
    EXPECT_NE(found.points.size(), searches.front().matches.points.size());
  }
}

TEST(TellOfOnePartTest, KeepsWhatThePartWithMostInliersHolds) {
  const auto part = [](SegmentId id, std::vector<LandmarkId> ids) {
    auto segment = std::make_shared<Segment>();
    segment->id = id;
    segment->points.ids = std::move(ids);
    segment->points.positions_in_map.resize(segment->points.ids.size());
    return segment;
  };
  const Segments parts = {part(4, {10, 20, 30}), part(7, {20, 30, 40})};
  const Segment joint = JoinSegments(parts);
  Localization answer;
  answer.evidence.confidence = 0.995;
  answer.matches.points = {{5, 0}, {6, 1}, {8, 2}, {9, 3}};  // landmarks 10, 20, 30, 40
  answer.point_match_inlier = {0, 1, 0, 1};
  TellOfOnePart(joint, parts, answer);
  EXPECT_EQ(answer.segment, 7);
  ASSERT_EQ(answer.matches.points.size(), 3u);
  EXPECT_EQ(answer.matches.points[0].feature, 6);
  EXPECT_EQ(answer.matches.points[0].landmark, 0) << "20, the part's first";
  EXPECT_EQ(answer.matches.points[2].feature, 9);
  EXPECT_EQ(answer.point_match_inlier, (std::vector<std::uint8_t>{1, 0, 1}));
  EXPECT_EQ(answer.evidence.points, (FeatureCounts{3, 2}));
  EXPECT_EQ(answer.evidence.confidence, 0.995);
}

// `whole` without the points whose id leaves `rest` when divided by two, and without lines.
std::shared_ptr<const Segment> Half(const Segment& whole, LandmarkId rest, SegmentId id) {
  auto half = std::make_shared<Segment>();
  half->map = whole.map;
  half->id = id;
  half->path_in_map = whole.path_in_map;
  half->points.descriptors.kind = whole.points.descriptors.kind;
  half->lines.descriptors.kind = whole.lines.descriptors.kind;
  for (int landmark = 0; landmark < whole.points.size(); ++landmark) {
    if (whole.points.ids[landmark] % 2 == rest) continue;
    for (std::size_t row = 0; row < whole.points.descriptor_landmark.size(); ++row) {
      if (whole.points.descriptor_landmark[row] != landmark) continue;
      const auto bytes = whole.points.descriptors.row(static_cast<int>(row));
      half->points.descriptors.bytes.insert(half->points.descriptors.bytes.end(), bytes.begin(),
                                            bytes.end());
      half->points.descriptor_landmark.push_back(half->points.size());
    }
    half->points.ids.push_back(whole.points.ids[landmark]);
    half->points.positions_in_map.push_back(whole.points.positions_in_map[landmark]);
  }
  return half;
}

std::shared_ptr<const Segment> Renamed(const Segment& segment, SegmentId id) {
  auto renamed = std::make_shared<Segment>(segment);
  renamed->id = id;
  return renamed;
}

Localization Answer(const Query& query, const DrawnWorld& world,
                    const std::vector<MapSnapshot::Entry>& entries) {
  const auto map = testing::ResidentMap(world.info(), entries);
  return Localize(query, **map, {}, kNoDeadline, nullptr).value();
}

TEST(LocalizeTest, SegmentsThatKnowTooLittleEachAnswerTogether) {
  int too_little = 0;
  int together = 0;
  for (int repetition = 0; repetition < 20; ++repetition) {
    Random random = testing::TestRandom(repetition);
    const DrawnWorld world(random.Fork(1));
    const Segment& whole = *world.segments()[1];
    const std::vector<MapSnapshot::Entry> halves = {{Half(whole, 0, 0), {}},
                                                    {Half(whole, 1, 1), {}}};
    const Rigid3 truth = DrawnWorld::CameraFromMapAt(18.0, 0.9);
    const Query query =
        world.See(truth, {.outlier_share = 0.0, .max_points = 9, .max_lines = 0}, random);
    const bool one_suffices = std::any_of(halves.begin(), halves.end(), [&](const auto& half) {
      return Answer(query, world, {{Renamed(*half.segment, 0), {}}}).outcome == Outcome::kLocalized;
    });
    if (one_suffices) continue;
    ++too_little;
    const Localization answer = Answer(query, world, halves);
    if (answer.outcome != Outcome::kLocalized) continue;
    ++together;
    EXPECT_LT((answer.map_from_body->translation - truth.Inverse().translation).norm(), 0.2);
    // What is told of matches is of the one segment that is named.
    const PointLandmarks& named = halves[answer.segment].segment->points;
    for (const FeatureMatch& match : answer.matches.points) EXPECT_LT(match.landmark, named.size());
    EXPECT_EQ(answer.matches.points.size(), answer.point_match_inlier.size());
    EXPECT_EQ(answer.evidence.points.matches, static_cast<int>(answer.matches.points.size()));
  }
  ASSERT_GE(too_little, 5);
  EXPECT_GE(together, too_little / 2) << "of " << too_little;
}

}  // namespace
}  // namespace maploc
