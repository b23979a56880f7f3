#include "server/pipeline/localizer.h"

#include <algorithm>
#include <utility>

#include <gmock/gmock.h>

#include "tests/support/drawn_world.h"
#include "tests/support/resident_map.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using testing::DrawnWorld;
using ::testing::HasSubstr;
using testing::QueryNoise;

std::shared_ptr<const MapSnapshot> Snapshot(const DrawnWorld& world,
                                            const StrategyDecision& decision = {}) {
  std::vector<MapSnapshot::Entry> entries;
  for (const auto& segment : world.segments()) entries.push_back({segment, decision});
  return testing::ResidentMap(world.info(), entries).value();
}

double PositionError(const Localization& answer, const Rigid3& camera_from_map,
                     const Rigid3& camera_from_body = {}) {
  const Rigid3 truth = camera_from_map.Inverse() * camera_from_body;
  return (answer.map_from_body->translation - truth.translation).norm();
}

// Leaves the keypoints within `radius_px` of `centre_px`, the first `most` of them.
void KeepPatch(const Eigen::Vector2f& centre_px, float radius_px, PointFeatures& points, int most) {
  PointFeatures kept;
  kept.descriptors.kind = points.descriptors.kind;
  for (int i = 0; i < points.descriptors.size(); ++i) {
    if (kept.descriptors.size() >= most) break;
    if ((points.keypoints_px[i] - centre_px).norm() > radius_px) continue;
    const auto row = points.descriptors.row(i);
    kept.keypoints_px.push_back(points.keypoints_px[i]);
    kept.descriptors.bytes.insert(kept.descriptors.bytes.end(), row.begin(), row.end());
  }
  points = std::move(kept);
}

class LocalizerTest : public ::testing::Test {
 protected:
  Result<Localization> Run(const Query& query) {
    return Localize(query, *snapshot_, options_, kNoDeadline, nullptr);
  }

  Random random_ = testing::TestRandom();
  DrawnWorld world_{testing::TestRandom(1)};
  std::shared_ptr<const MapSnapshot> snapshot_ = Snapshot(world_);
  LocalizerOptions options_;
  Rigid3 camera_from_map_ = DrawnWorld::CameraFromMapAt(16.0, 0.6);
};

TEST_F(LocalizerTest, FindsTheRobotInTheSegmentThatItSees) {
  const Query query = world_.See(camera_from_map_, {}, random_);
  const auto answer = Run(query);
  ASSERT_TRUE(answer.ok()) << answer.status().ToString();
  ASSERT_EQ(answer->outcome, Outcome::kLocalized);
  EXPECT_LT(PositionError(*answer, camera_from_map_), 0.05);
  EXPECT_EQ(answer->map, world_.info().key);
  EXPECT_TRUE(answer->segment == 1 || answer->segment == 2) << answer->segment;
  EXPECT_GE(answer->evidence.confidence, options_.min_confidence);
  EXPECT_GT(answer->covariance.trace(), 0.0);
  EXPECT_EQ(answer->strategy_source, StrategySource::kDefault);
}

TEST_F(LocalizerTest, AQueryMayBringItsOwnThreshold) {
  Query query = world_.See(camera_from_map_, {.pixel_sigma = 4.0, .outlier_share = 0.0}, random_);
  const auto by_default = Run(query);
  query.max_error_px = 16.0;
  const auto by_own = Run(query);
  ASSERT_TRUE(by_default.ok() && by_own.ok());
  EXPECT_GT(by_own->evidence.points.inliers, by_default->evidence.points.inliers);
  EXPECT_GE(by_own->evidence.points.inliers, 0.9 * by_own->evidence.points.matches);
}

TEST_F(LocalizerTest, EvidenceCountsWhatTheFlagsSay) {
  const auto answer = Run(world_.See(camera_from_map_, {}, random_));
  ASSERT_TRUE(answer.ok());
  const Evidence& evidence = answer->evidence;
  const auto ones = [](const std::vector<std::uint8_t>& flags) {
    return static_cast<int>(std::count(flags.begin(), flags.end(), 1));
  };
  EXPECT_EQ(evidence.points.matches, static_cast<int>(answer->matches.points.size()));
  EXPECT_EQ(evidence.points.inliers, ones(answer->point_match_inlier));
  EXPECT_EQ(evidence.usable_lines.matches + evidence.vertical_lines.matches,
            static_cast<int>(answer->matches.lines.size()));
  EXPECT_EQ(evidence.usable_lines.inliers + evidence.vertical_lines.inliers,
            ones(answer->line_match_inlier));
  EXPECT_GT(evidence.vertical_lines.inliers, 0);
  EXPECT_GT(evidence.usable_lines.inliers, 0);
}

// The statistics must not depend on the strategy that found the pose.
TEST_F(LocalizerTest, EveryStrategyGivesTheSameEvidence) {
  Query query = world_.See(camera_from_map_, {}, random_);
  query.requested_strategy = Strategy::k2P;
  const auto two_points = Run(query);
  query.requested_strategy = Strategy::k1P1L;
  const auto point_line = Run(query);
  ASSERT_TRUE(two_points.ok() && point_line.ok());
  EXPECT_EQ(two_points->evidence.strategy, Strategy::k2P);
  EXPECT_EQ(point_line->evidence.strategy, Strategy::k1P1L);
  EXPECT_EQ(two_points->evidence.points.matches, point_line->evidence.points.matches);
  EXPECT_NEAR(two_points->evidence.points.inliers, point_line->evidence.points.inliers, 2);
  EXPECT_NEAR(two_points->evidence.usable_lines.inliers, point_line->evidence.usable_lines.inliers,
              1);
  EXPECT_NEAR(two_points->evidence.vertical_lines.inliers,
              point_line->evidence.vertical_lines.inliers, 1);
}

TEST_F(LocalizerTest, ARequestedStrategyGoesBeforeTheSegments) {
  snapshot_ = Snapshot(world_, {Strategy::k2P,
                                StrategySource::kLearned,
                                "",
                                0.5,
                                {Strategy::k2P, Strategy::kMixed, Strategy::k1P1L}});
  Query query = world_.See(camera_from_map_, {}, random_);
  EXPECT_EQ(Run(query)->evidence.strategy, Strategy::k2P);
  EXPECT_EQ(Run(query)->strategy_source, StrategySource::kLearned);
  query.requested_strategy = Strategy::k1P1L;
  EXPECT_EQ(Run(query)->evidence.strategy, Strategy::k1P1L);
  EXPECT_EQ(Run(query)->strategy_source, StrategySource::kRequested);
}

TEST_F(LocalizerTest, AStrategyThatCannotBeDrawnFallsBackAndSaysSo) {
  Query query = world_.See(camera_from_map_, {.max_lines = 0}, random_);
  query.requested_strategy = Strategy::k1P1L;
  const auto answer = Run(query);
  ASSERT_TRUE(answer.ok());
  EXPECT_EQ(answer->outcome, Outcome::kLocalized);
  EXPECT_TRUE(answer->evidence.fell_back);
  EXPECT_NE(answer->evidence.strategy, Strategy::k1P1L);
}

// The only line is somewhere else, so that a point and a line give no pose; two points do. RANSAC
// finds three inliers all the same: it is the judgement that sends the query to the next strategy.
TEST_F(LocalizerTest, AStrategyThatFindsNothingGivesWayToTheNextBest) {
  const DrawnWorld tilted(testing::TestRandom(2), {.vertical_line_share = 0.0});
  const std::array ranking = {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed};
  snapshot_ = Snapshot(tilted, {Strategy::k1P1L, StrategySource::kLearned, "", 0.2, ranking});
  Query query = tilted.See(camera_from_map_, {.outlier_share = 0.3, .max_lines = 1}, random_);
  ASSERT_EQ(query.views[0].lines.size(), 1);
  query.views[0].lines.starts_px[0] = {20, 30};
  query.views[0].lines.ends_px[0] = {40, 580};

  const auto answer = Run(query);

  ASSERT_EQ(answer->outcome, Outcome::kLocalized);
  EXPECT_LT(PositionError(*answer, camera_from_map_), 0.05);
  EXPECT_EQ(answer->evidence.strategy, Strategy::k2P);
  EXPECT_TRUE(answer->evidence.fell_back);
  EXPECT_EQ(answer->strategy_source, StrategySource::kLearned);
  query.requested_strategy = Strategy::k2P;
  const int alone = Run(query)->evidence.iterations;
  EXPECT_GE(answer->evidence.iterations, alone);  // of both strategies
  // The hopeless one was expected to succeed in one of five iterations, and had no more than 200.
  EXPECT_LE(answer->evidence.iterations, 200 + 2 * alone);
}

TEST_F(LocalizerTest, TheSameRequestGivesTheSameAnswerToTheBit) {
  Query query = world_.See(camera_from_map_, {.outlier_share = 0.6}, random_);
  query.request_id = "first";
  const auto first = Run(query);
  query.request_id = "second";
  query.session = "of another session";
  const auto second = Run(query);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first->map_from_body->translation, second->map_from_body->translation);
  EXPECT_EQ(first->map_from_body->rotation.coeffs(), second->map_from_body->rotation.coeffs());
  EXPECT_EQ(first->covariance, second->covariance);
  EXPECT_EQ(first->evidence.iterations, second->evidence.iterations);
}

TEST_F(LocalizerTest, AnswersTheBodysPose) {
  const Rigid3 camera_from_body{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized())),
      {0.5, -2.0, 1.0}};
  const Query query = world_.See(camera_from_map_, {}, random_, camera_from_body);
  const auto answer = Run(query);
  ASSERT_TRUE(answer.ok());
  ASSERT_EQ(answer->outcome, Outcome::kLocalized);
  EXPECT_LT(PositionError(*answer, camera_from_map_, camera_from_body), 0.08);
}

// A hint and never a constraint: off the map, in another segment, or a few metres off.
TEST_F(LocalizerTest, AWrongPriorDoesNotHideThePlace) {
  Query query = world_.See(camera_from_map_, {}, random_);
  for (const Eigen::Vector3d& prior :
       {Eigen::Vector3d(0, 500, 0), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(11, 0.6, 0)}) {
    SCOPED_TRACE(prior.transpose());
    query.prior = PosePrior{prior, 0.1};
    const auto answer = Run(query);
    ASSERT_TRUE(answer.ok());
    ASSERT_EQ(answer->outcome, Outcome::kLocalized);
    EXPECT_LT(PositionError(*answer, camera_from_map_), 0.05);
  }
}

TEST_F(LocalizerTest, APriorOffTheMapIsOutOfMapWhereThePictureShowsNoPlaceEither) {
  Query query = world_.See(camera_from_map_, {.outlier_share = 1.0}, random_);
  query.prior = PosePrior{{0.0, 500.0, 0.0}, 1.0};
  const auto answer = Run(query);
  ASSERT_TRUE(answer.ok());
  EXPECT_EQ(answer->outcome, Outcome::kOutOfMap);
  EXPECT_EQ(answer->segment, -1);
  EXPECT_FALSE(answer->map_from_body);
}

TEST_F(LocalizerTest, NothingToMatchIsTooFewMatchesInTheBestRankedSegment) {
  Query query = world_.See(camera_from_map_, {.max_points = 1, .max_lines = 0}, random_);
  const auto answer = Run(query);
  ASSERT_TRUE(answer.ok());
  EXPECT_EQ(answer->outcome, Outcome::kTooFewMatches);
  EXPECT_GE(answer->segment, 0);
  EXPECT_FALSE(answer->map_from_body);
}

TEST_F(LocalizerTest, NothingButOutliersGivesNoPose) {
  const auto answer = Run(world_.See(camera_from_map_, {.outlier_share = 1.0}, random_));
  ASSERT_TRUE(answer.ok());
  EXPECT_TRUE(answer->outcome == Outcome::kNoConsensus ||
              answer->outcome == Outcome::kLowConfidence)
      << OutcomeName(answer->outcome);
  EXPECT_FALSE(answer->map_from_body);
  EXPECT_LT(answer->evidence.confidence, options_.min_confidence);
}

// A fault of the accelerometer: the matches are good enough to tell, and to answer without it. At
// 20 degrees no sample of two entities finds the pose.
TEST_F(LocalizerTest, AWrongGravityIsToldAndNotUsed) {
  for (const double error_rad : {0.04, 0.35}) {
    const auto answer = Run(world_.See(
        camera_from_map_, {.gravity_sigma_rad = 0.005, .gravity_error_rad = error_rad}, random_));
    ASSERT_TRUE(answer.ok());
    ASSERT_EQ(answer->outcome, Outcome::kLocalized) << error_rad;
    EXPECT_LT(PositionError(*answer, camera_from_map_), 0.05);
    EXPECT_TRUE(answer->evidence.gravity_rejected);
    EXPECT_NEAR(answer->evidence.gravity_disagreement_rad, error_rad, 0.02);
    EXPECT_EQ(answer->evidence.strategy, Strategy::kP3P);
    EXPECT_TRUE(answer->evidence.fell_back);
    EXPECT_EQ(answer->strategy_source, StrategySource::kDefault);
  }
}

// How large a patch of the picture has matches, how many at most, and how wrong gravity is.
struct PatchRange {
  double least_radius_px = 25;
  double largest_radius_px = 70;
  int most_points = 2000;
  double outlier_share = 0.1;
  double least_error_rad = 0.05;
  double largest_error_rad = 0.2;
};

// Matches on a patch of the picture determine a pose with gravity alone. When gravity is wrong none
// may be answered, at any size of the patch and of the error, but where the matches alone determine
// the pose: then within the limits of `server/trust`, whether or not they suffice to refute a
// gravity that is three to four degrees off.
TEST_F(LocalizerTest, WhatOnlyAWrongGravityHoldsIsNotAnswered) {
  const DrawnWorld dense(testing::TestRandom(2), {.points_a_metre = 80, .lines_a_metre = 0});
  snapshot_ = Snapshot(dense);
  int inconsistent = 0;
  int believed = 0;
  const auto ask = [&](const PatchRange& range) {
    const double error_rad = random_.Uniform(range.least_error_rad, range.largest_error_rad);
    const QueryNoise noise{.gravity_sigma_rad = 0.005,
                           .gravity_error_rad = error_rad,
                           .outlier_share = range.outlier_share,
                           .max_points = 2000,
                           .max_lines = 0};
    Query query = dense.See(camera_from_map_, noise, random_);
    const float x = static_cast<float>(random_.Uniform(250, 550));
    const float y = static_cast<float>(random_.Uniform(200, 400));
    const double radius = random_.Uniform(range.least_radius_px, range.largest_radius_px);
    KeepPatch({x, y}, static_cast<float>(radius), query.views[0].points, range.most_points);
    const auto answer = Run(query);
    ASSERT_TRUE(answer.ok());
    inconsistent += answer->outcome == Outcome::kGravityInconsistent ? 1 : 0;
    if (!answer->map_from_body) return;
    EXPECT_TRUE(answer->evidence.gravity_rejected || error_rad < 0.075) << error_rad;
    believed += answer->evidence.gravity_rejected ? 0 : 1;
    EXPECT_LT(PositionError(*answer, camera_from_map_), 0.5);
  };
  for (int i = 0; i < 200; ++i) ask({});
  EXPECT_LE(believed, 4);  // 5 of 4000 under seeds 1 to 20
  // Here the wrong gravity's pose has enough inliers to be believed with it and too few without,
  // in one query of twenty; of those above, in one of a hundred.
  for (int i = 0; i < 240; ++i) ask({48, 52, 16, 0.0, 0.08, 0.1});
  EXPECT_GE(inconsistent, 3);
}

TEST_F(LocalizerTest, AnHonestGravityIsNotRejected) {
  for (int i = 0; i < 20; ++i) {
    const auto answer = Run(world_.See(camera_from_map_, {}, random_));
    ASSERT_EQ(answer->outcome, Outcome::kLocalized);
    EXPECT_FALSE(answer->evidence.gravity_rejected);
    EXPECT_LT(answer->evidence.gravity_disagreement_rad, 0.06);
  }
}

TEST_F(LocalizerTest, AbsentGravityIsAnsweredByThreePoints) {
  Query query = world_.See(camera_from_map_, {}, random_);
  query.gravity.reset();
  for (const auto requested : {std::optional<Strategy>(), std::optional(Strategy::k2P)}) {
    query.requested_strategy = requested;
    const auto answer = Run(query);
    ASSERT_TRUE(answer.ok()) << answer.status().ToString();
    ASSERT_EQ(answer->outcome, Outcome::kLocalized);
    EXPECT_LT(PositionError(*answer, camera_from_map_), 0.05);
    EXPECT_EQ(answer->evidence.strategy, Strategy::kP3P);
    EXPECT_TRUE(answer->evidence.fell_back);
    EXPECT_FALSE(answer->evidence.gravity_rejected);
    EXPECT_EQ(answer->evidence.gravity_disagreement_rad, 0.0);
  }
  query.requested_strategy = Strategy::kP3P;
  EXPECT_FALSE(Run(query)->evidence.fell_back);
}

TEST_F(LocalizerTest, ThreePointsMayBeAskedForWithGravity) {
  Query query = world_.See(camera_from_map_, {}, random_);
  query.requested_strategy = Strategy::kP3P;
  const auto answer = Run(query);
  ASSERT_EQ(answer->outcome, Outcome::kLocalized);
  EXPECT_EQ(answer->evidence.strategy, Strategy::kP3P);
  EXPECT_LT(PositionError(*answer, camera_from_map_), 0.05);
}

TEST_F(LocalizerTest, TwoPointsWithoutGravityAreTooFew) {
  Query query = world_.See(camera_from_map_, {.max_points = 2}, random_);
  query.gravity.reset();
  EXPECT_EQ(Run(query)->outcome, Outcome::kTooFewMatches);
}

TEST_F(LocalizerTest, OneViewIsServed) {
  Query query = world_.See(camera_from_map_, {}, random_);
  query.views.push_back(query.views[0]);
  EXPECT_EQ(Run(query).status().code(), StatusCode::kInvalidArgument);
  query.views.clear();
  EXPECT_EQ(Run(query).status().code(), StatusCode::kInvalidArgument);
}

TEST_F(LocalizerTest, ADescriptorMismatchNamesBothKinds) {
  Query query = world_.See(camera_from_map_, {}, random_);
  query.views[0].points.descriptors.kind.name = "binary32";
  const auto answer = Run(query);
  ASSERT_FALSE(answer.ok());
  EXPECT_EQ(answer.status().code(), StatusCode::kFailedPrecondition);
  EXPECT_EQ(answer.status().reason(), "DESCRIPTOR_KIND_MISMATCH");
  EXPECT_THAT(answer.status().message(), HasSubstr("binary32"));
  EXPECT_THAT(answer.status().message(), HasSubstr("orb"));
}

TEST_F(LocalizerTest, StopsAtTheDeadlineAndOnCancel) {
  const Query query = world_.See(camera_from_map_, {}, random_);
  const auto late =
      Localize(query, *snapshot_, options_, std::chrono::steady_clock::now(), nullptr);
  EXPECT_EQ(late.status().code(), StatusCode::kDeadlineExceeded);
  const std::atomic<bool> cancelled = true;
  const auto given_up = Localize(query, *snapshot_, options_, kNoDeadline, &cancelled);
  EXPECT_EQ(given_up.status().code(), StatusCode::kCancelled);
}

TEST_F(LocalizerTest, StageTimesAddUpToLessThanTheTotal) {
  const auto answer = Run(world_.See(camera_from_map_, {}, random_));
  const StageTimes& times = answer->times;
  EXPECT_GT(times.matching_ms, 0.0);
  EXPECT_GT(times.ransac_ms, 0.0);
  EXPECT_GT(times.refinement_ms, 0.0);
  EXPECT_LE(times.retrieval_ms + times.matching_ms + times.ransac_ms + times.refinement_ms,
            times.total_ms);
}

TEST(BuildMapSnapshotTest, RefusesSegmentsOutOfTheirPlace) {
  const DrawnWorld world(testing::TestRandom());
  EXPECT_FALSE(testing::ResidentMap(world.info(), {{world.segments()[1], {}}}).ok());
  const std::vector<SegmentPlace> places = {PlaceOf(*world.segments()[0])};
  EXPECT_FALSE(BuildMapSnapshot(world.info(), {}, places, nullptr).ok());
}

TEST(EmptyMapTest, IsOutOfMap) {
  const DrawnWorld world(testing::TestRandom());
  Random random = testing::TestRandom(1);
  const auto snapshot = testing::ResidentMap(world.info(), {}).value();
  const Query query = world.See(DrawnWorld::CameraFromMapAt(5.0, 0.5), {}, random);
  const auto answer = Localize(query, *snapshot, {}, kNoDeadline, nullptr);
  ASSERT_TRUE(answer.ok());
  EXPECT_EQ(answer->outcome, Outcome::kOutOfMap);
}

}  // namespace
}  // namespace maploc
