#include <algorithm>

#include <gmock/gmock.h>

#include "mapstore/base/even_sample.h"
#include "server/matching/segment_matching.h"
#include "server/pipeline/localizer.h"
#include "tests/support/drawn_world.h"
#include "tests/support/resident_map.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using testing::DrawnWorld;
using testing::QueryNoise;

constexpr int kManyPoints = 1500;
constexpr int kSampledPoints = 300;

// A street with so many points that a query is first localized by a sample of them.
class CoarseToFineTest : public ::testing::Test {
 protected:
  CoarseToFineTest() {
    std::vector<MapSnapshot::Entry> entries;
    for (const auto& segment : world_.segments()) entries.push_back({segment, {}});
    snapshot_ = testing::ResidentMap(world_.info(), entries).value();
  }

  Query See(double outlier_share, int points = kManyPoints) {
    return world_.See(camera_from_map_,
                      QueryNoise{.outlier_share = outlier_share, .max_points = points}, random_);
  }

  Localization Run(const Query& query) {
    return Localize(query, *snapshot_, {}, kNoDeadline, nullptr).value();
  }

  // Of the full search in the segment that answered.
  std::vector<FeatureMatch> FullMatches(const Query& query, const Localization& answer) {
    return MatchSegment(query.views.front(), *world_.segments()[answer.segment]).points;
  }

  double PositionError(const Localization& answer) {
    return (answer.map_from_body->translation - camera_from_map_.Inverse().translation).norm();
  }

  double ErrorPx(const Query& query, const Localization& answer, const FeatureMatch& match) {
    const View& view = query.views.front();
    const Eigen::Vector3d& position =
        world_.segments()[answer.segment]->points.positions_in_map[match.landmark];
    const auto pixel = view.camera.Project(camera_from_map_ * position);
    return pixel ? (*pixel - view.points.keypoints_px[match.feature].cast<double>()).norm() : 1e9;
  }

  Random random_ = testing::TestRandom();
  DrawnWorld world_{testing::TestRandom(1), {.points_a_metre = 250}};
  std::shared_ptr<const MapSnapshot> snapshot_;
  Rigid3 camera_from_map_ = DrawnWorld::CameraFromMapAt(16.0, 0.6);
};

TEST_F(CoarseToFineTest, UsesAllPointsForThePose) {
  const Query query = See(0.1);
  ASSERT_EQ(query.views.front().points.descriptors.size(), kManyPoints);
  const Localization answer = Run(query);
  ASSERT_EQ(answer.outcome, Outcome::kLocalized);
  EXPECT_LT(PositionError(answer), 0.01);
  const auto right = std::ranges::count_if(FullMatches(query, answer), [&](const FeatureMatch& m) {
    return ErrorPx(query, answer, m) < 4.0;
  });
  const auto inliers = std::ranges::count(answer.point_match_inlier, 1);
  EXPECT_GT(inliers, 0.85 * right);
  EXPECT_GT(inliers, 3 * kSampledPoints);
  for (std::size_t i = 0; i < answer.matches.points.size(); ++i) {
    if (answer.point_match_inlier[i] == 0) continue;
    EXPECT_LT(ErrorPx(query, answer, answer.matches.points[i]), 6.0);
  }
}

// Statistics add this to what full searches count; matches that were looked for near the pose would
// make every segment look better than it is.
TEST_F(CoarseToFineTest, EvidenceEstimatesThatOfTheFullSearch) {
  const Query query = See(0.1);
  const Localization answer = Run(query);
  ASSERT_EQ(answer.outcome, Outcome::kLocalized);
  const std::vector<int> sample = EvenSample(kManyPoints, kSampledPoints);
  FeatureCounts want;
  for (const FeatureMatch& match : FullMatches(query, answer)) {
    if (!std::ranges::binary_search(sample, match.feature)) continue;
    ++want.matches;
    want.inliers += ErrorPx(query, answer, match) < 4.0 ? 1 : 0;
  }
  constexpr int kTimes = kManyPoints / kSampledPoints;
  EXPECT_EQ(answer.evidence.points.matches, kTimes * want.matches);
  EXPECT_NEAR(answer.evidence.points.inliers, kTimes * want.inliers, 3 * kTimes);
  EXPECT_LT(answer.evidence.points.inliers, answer.evidence.points.matches);
}

TEST_F(CoarseToFineTest, EachFeatureAndEachLandmarkMatchesOnce) {
  const Localization answer = Run(See(0.1));
  std::vector<int> features, landmarks;
  for (const FeatureMatch& match : answer.matches.points) {
    features.push_back(match.feature);
    landmarks.push_back(match.landmark);
  }
  for (std::vector<int>* list : {&features, &landmarks}) {
    std::ranges::sort(*list);
    EXPECT_EQ(std::ranges::adjacent_find(*list), list->end());
  }
}

// Where the sample's pose leaves a quarter unexplained, the full search decides as if there had
// been no sample.
TEST_F(CoarseToFineTest, APoorSampleLeavesItToTheFullSearch) {
  const Query query = See(0.5);
  const Localization answer = Run(query);
  ASSERT_EQ(answer.outcome, Outcome::kLocalized);
  EXPECT_EQ(answer.evidence.points.matches, static_cast<int>(FullMatches(query, answer).size()));
  EXPECT_EQ(answer.matches.points.size(), FullMatches(query, answer).size());
}

// A threshold of a tenth of a pixel, or of a hundred, is a client's own to choose.
TEST_F(CoarseToFineTest, AnyThresholdOfTheQueryIsServed) {
  for (const double max_error_px : {0.1, 1000.0}) {
    Query query = See(0.0);
    query.max_error_px = max_error_px;
    const Localization answer = Run(query);
    EXPECT_LE(answer.evidence.points.inliers, answer.evidence.points.matches);
  }
}

TEST_F(CoarseToFineTest, FewPointsAreMatchedAtOnce) {
  const Query query = See(0.1, 900);
  const Localization answer = Run(query);
  EXPECT_EQ(answer.evidence.points.matches, static_cast<int>(FullMatches(query, answer).size()));
}

// What looks like the place by chance is not localized for being looked for.
TEST_F(CoarseToFineTest, NothingButOutliersGivesNoPose) {
  const Localization answer = Run(See(1.0));
  EXPECT_NE(answer.outcome, Outcome::kLocalized);
}

}  // namespace
}  // namespace maploc
