#include "server/retrieval/ranking.h"

#include <gmock/gmock.h>

#include "mapstore/geometry/path_distance.h"
#include "tests/support/seed.h"
#include "tests/support/segment_places.h"

namespace maploc {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const DescriptorKind kKind{"orb", 32, DescriptorMetric::kHamming};

std::vector<std::uint8_t> RandomRow(Random& random) {
  std::vector<std::uint8_t> row(kKind.bytes);
  for (std::uint8_t& byte : row) byte = static_cast<std::uint8_t>(random.Below(256));
  return row;
}

// A corridor along x: segment s covers x in [10 s, 10 s + 15], so neighbours share their border's
// landmarks. One landmark a metre on each of both walls, 2 m off the path.
//
//   seg 0  o---------------o
//   seg 1            o---------------o
//   seg 2                      o---------------o
class Corridor {
 public:
  static constexpr int kSegments = 4;
  static constexpr int kLength = 45;

  explicit Corridor(Random random) {
    for (int i = 0; i < 2 * kLength; ++i) rows_.push_back(RandomRow(random));
    for (int s = 0; s < kSegments; ++s) segments_.push_back(MakeSegment(s));
    places_ = PlaceIndex::Build(testing::PlacesOf(segments_));
  }

  const std::vector<std::shared_ptr<const Segment>>& segments() const { return segments_; }
  const PlaceIndex& places() const { return places_; }

  // What a robot at `x` sees: the landmarks within 4 m, each described as in the map but for a few
  // bits.
  PointFeatures SeenFrom(int x, Random& random) const {
    PointFeatures features{{}, {kKind, {}}};
    for (int i = 0; i < 2 * kLength; ++i) {
      if (std::abs(i / 2 - x) > 4) continue;
      std::vector<std::uint8_t> row = rows_[i];
      for (int flip = 0; flip < 10; ++flip) row[random.Below(32)] ^= 1 << random.Below(8);
      features.descriptors.bytes.insert(features.descriptors.bytes.end(), row.begin(), row.end());
      features.keypoints_px.emplace_back(0.0f, 0.0f);
    }
    return features;
  }

 private:
  std::shared_ptr<const Segment> MakeSegment(int s) const {
    auto segment = std::make_shared<Segment>();
    segment->id = s;
    segment->path_in_map = {{10.0 * s, 0, 0}, {10.0 * s + 15, 0, 0}};
    segment->points.descriptors.kind = kKind;
    for (int x = 10 * s; x < std::min(10 * s + 15, kLength); ++x) {
      for (int side = 0; side < 2; ++side) AddLandmark(2 * x + side, segment->points);
    }
    return segment;
  }

  void AddLandmark(int id, PointLandmarks& points) const {
    points.ids.push_back(id);
    points.positions_in_map.emplace_back(id / 2, id % 2 == 0 ? -2.0 : 2.0, 0.0);
    points.descriptors.bytes.insert(points.descriptors.bytes.end(), rows_[id].begin(),
                                    rows_[id].end());
    points.descriptor_landmark.push_back(points.size() - 1);
  }

  std::vector<std::vector<std::uint8_t>> rows_;
  std::vector<std::shared_ptr<const Segment>> segments_;
  PlaceIndex places_;
};

class RankingTest : public ::testing::Test {
 protected:
  std::vector<int> Rank(int seen_from, const std::optional<PosePrior>& prior) {
    return RankSegments(corridor_.SeenFrom(seen_from, random_), prior, corridor_.places(), options_)
        .segments;
  }

  Random random_ = testing::TestRandom();
  Corridor corridor_{testing::TestRandom(1)};
  RetrievalOptions options_{.max_segments = 2};
};

TEST_F(RankingTest, ThePlaceThatIsSeenWinsWithoutPrior) {
  EXPECT_EQ(Rank(5, std::nullopt).front(), 0);
  EXPECT_EQ(Rank(18, std::nullopt).front(), 1);
  EXPECT_EQ(Rank(28, std::nullopt).front(), 2);
  EXPECT_EQ(Rank(40, std::nullopt).front(), 3);
}

// A long map is searched as a whole first; the segment that is seen must survive the shortlist.
TEST_F(RankingTest, TheShortlistKeepsThePlaceThatIsSeen) {
  options_ = {.max_segments = 1, .max_shortlist = 1};
  EXPECT_THAT(Rank(5, std::nullopt), ElementsAre(0));
  EXPECT_THAT(Rank(28, std::nullopt), ElementsAre(2));
  EXPECT_THAT(Rank(40, std::nullopt), ElementsAre(3));
}

// Two segments mapped the same wall apart, so that each of its landmarks has a twin. A search over
// the whole map finds no clear match there; segment by segment there is one.
TEST(SegmentScoreTest, TwinsInAnotherSegmentDoNotHideAPlace) {
  Random random = testing::TestRandom();
  const auto wall = [&](int id) {
    auto segment = std::make_shared<Segment>();
    segment->id = id;
    segment->points.descriptors.kind = kKind;
    Random same = testing::TestRandom(1);
    for (int i = 0; i < 30; ++i) {
      const std::vector<std::uint8_t> row = RandomRow(same);
      segment->points.ids.push_back(100 * id + i);
      segment->points.positions_in_map.emplace_back(i, 0, 0);
      segment->points.descriptors.bytes.insert(segment->points.descriptors.bytes.end(), row.begin(),
                                               row.end());
      segment->points.descriptor_landmark.push_back(i);
    }
    return std::shared_ptr<const Segment>(segment);
  };
  const std::vector<std::shared_ptr<const Segment>> segments = {wall(0), wall(1)};
  Descriptors seen = segments[0]->points.descriptors;
  for (std::uint8_t& byte : seen.bytes) byte ^= random.Below(4) == 0 ? 1 << random.Below(8) : 0;
  const PlaceIndex places = PlaceIndex::Build(testing::PlacesOf(segments));
  EXPECT_EQ(CountVotes(seen, places, 2, 0.8f)[0], 0);
  EXPECT_GT(SegmentScore(MatchPlace(seen, places, 0, 0.8f)), 20.0);
}

TEST_F(RankingTest, AtABorderBothNeighboursAreCandidates) {
  EXPECT_THAT(Rank(12, std::nullopt), ::testing::UnorderedElementsAre(0, 1));
}

TEST_F(RankingTest, WithoutFeaturesTheOrderIsById) {
  EXPECT_THAT(RankSegments({}, std::nullopt, corridor_.places(), options_).segments,
              ElementsAre(0, 1));
}

TEST_F(RankingTest, APriorNearOneSegmentLeavesTheOthersOut) {
  EXPECT_THAT(Rank(40, PosePrior{{3.0, 0.0, 0.0}, 0.5}), ElementsAre(0));
}

TEST_F(RankingTest, AWidePriorIsRankedByWhatIsSeen) {
  EXPECT_EQ(Rank(40, PosePrior{{3.0, 0.0, 0.0}, 20.0}).front(), 3);
}

TEST_F(RankingTest, APriorFarFromEverythingIsOutOfMap) {
  EXPECT_THAT(Rank(5, PosePrior{{0.0, 100.0, 0.0}, 1.0}), IsEmpty());
}

TEST_F(RankingTest, ThePriorsGateIsFourSigmasAndTheReach) {
  EXPECT_DOUBLE_EQ(corridor_.places().ReachOf(0), 2.0);
  EXPECT_THAT(Rank(5, PosePrior{{0.0, 5.9, 0.0}, 1.0}), ElementsAre(0));
  EXPECT_THAT(Rank(5, PosePrior{{0.0, 6.1, 0.0}, 1.0}), IsEmpty());
}

TEST_F(RankingTest, AMapWithoutSegmentsHasNoCandidates) {
  const PlaceIndex places = PlaceIndex::Build({});
  EXPECT_THAT(RankSegments(corridor_.SeenFrom(5, random_), std::nullopt, places).segments,
              IsEmpty());
}

TEST(PlaceIndexTest, SharedLandmarksStandOnceAndNameAllTheirSegments) {
  const Corridor corridor(testing::TestRandom());
  const PlaceIndex& places = corridor.places();
  EXPECT_EQ(places.landmark_count(), 2 * Corridor::kLength);
  EXPECT_EQ(places.descriptors().size(), 2 * Corridor::kLength);
  EXPECT_THAT(places.SegmentsOf(2 * 5), ElementsAre(0));
  EXPECT_THAT(places.SegmentsOf(2 * 12), ElementsAre(0, 1));
}

TEST(PlaceIndexTest, TakesTheRicherDescription) {
  Random random = testing::TestRandom();
  const auto make = [&](int id, int rows) {
    auto segment = std::make_shared<Segment>();
    segment->id = id;
    segment->points.ids = {7};
    segment->points.positions_in_map = {Eigen::Vector3d::Zero()};
    segment->points.descriptors.kind = kKind;
    for (int i = 0; i < rows; ++i) {
      const auto row = RandomRow(random);
      segment->points.descriptors.bytes.insert(segment->points.descriptors.bytes.end(), row.begin(),
                                               row.end());
      segment->points.descriptor_landmark.push_back(0);
    }
    return std::shared_ptr<const Segment>(segment);
  };
  const std::vector<std::shared_ptr<const Segment>> segments = {make(0, 1), make(1, 3)};
  const PlaceIndex places = PlaceIndex::Build(testing::PlacesOf(segments));
  EXPECT_EQ(places.landmark_count(), 1);
  EXPECT_THAT(places.row_landmark(), ElementsAre(0, 0));
  EXPECT_THAT(places.RowsOf(0), ElementsAre(0, 1));
  // Two of the three, as they are.
  const Descriptors& all = segments[1]->points.descriptors;
  int found = 0;
  for (int i = 0; i < 3; ++i) {
    for (int kept = 0; kept < 2; ++kept) {
      found += std::ranges::equal(all.row(i), places.descriptors().row(kept)) ? 1 : 0;
    }
  }
  EXPECT_EQ(found, 2);
  EXPECT_FALSE(std::ranges::equal(places.descriptors().row(0), places.descriptors().row(1)));
}

TEST(PathDistanceTest, MeasuresToThePolylineNotToItsPoints) {
  const std::vector<Eigen::Vector3d> path = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}};
  EXPECT_DOUBLE_EQ(DistanceToPath({5, 3, 0}, path), 3.0);
  EXPECT_DOUBLE_EQ(DistanceToPath({-3, 4, 0}, path), 5.0);
  EXPECT_DOUBLE_EQ(DistanceToPath({12, 5, 0}, path), 2.0);
  EXPECT_DOUBLE_EQ(DistanceToPath({1, 0, 0}, std::vector<Eigen::Vector3d>{{0, 0, 0}}), 1.0);
  EXPECT_TRUE(std::isinf(DistanceToPath({0, 0, 0}, {})));
}

}  // namespace
}  // namespace maploc
