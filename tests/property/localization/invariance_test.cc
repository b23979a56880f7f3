// What must hold for any world and any pose: recovery, and answers that do not depend on the order
// of features or of segments' neighbours.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "server/pipeline/localizer.h"
#include "tests/support/drawn_world.h"
#include "tests/support/resident_map.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using testing::DrawnWorld;
using testing::QueryNoise;

std::shared_ptr<const MapSnapshot> Snapshot(const DrawnWorld& world) {
  std::vector<MapSnapshot::Entry> entries;
  for (const auto& segment : world.segments()) entries.push_back({segment, {}});
  return testing::ResidentMap(world.info(), entries).value();
}

double PositionError(const Localization& answer, const Rigid3& camera_from_map) {
  return (answer.map_from_body->translation - camera_from_map.Inverse().translation).norm();
}

// The features in reverse.
PointFeatures Reversed(const PointFeatures& features) {
  PointFeatures reversed{{}, {features.descriptors.kind, {}}};
  for (int i = features.descriptors.size() - 1; i >= 0; --i) {
    const auto row = features.descriptors.row(i);
    reversed.keypoints_px.push_back(features.keypoints_px[i]);
    reversed.descriptors.bytes.insert(reversed.descriptors.bytes.end(), row.begin(), row.end());
  }
  return reversed;
}

// The fronts, 5 m aside, are in the picture (39 degrees to each side of its axis) from 6 m ahead
// on. A camera with less than 10 m of the street ahead looks out of the map, and sees little of it.
bool LooksOutOfTheMap(double x, double yaw_rad) {
  constexpr double kStreetLength = 36.0;
  const double ahead = x + 10.0 * std::cos(yaw_rad);
  return ahead < 0.0 || ahead > kStreetLength;
}

// Anywhere on the street, looking along it or at a front. A camera that looks out of the map need
// not be found.
TEST(LocalizationPropertyTest, PosesAnywhereAreFoundAndNoneIsWrong) {
  constexpr int kPoses = 40;
  int poses = 0;
  int localized = 0;
  for (int repetition = 0; poses < kPoses; ++repetition) {
    Random random = testing::TestRandom(repetition);
    const DrawnWorld world(random.Fork(1));
    const double x = random.Uniform(2, 30);
    const double yaw = random.Uniform(-std::numbers::pi, std::numbers::pi);
    const Rigid3 truth = DrawnWorld::CameraFromMapAt(x, yaw, random.Uniform(-0.15, 0.15));
    const bool sees_map = !LooksOutOfTheMap(x, yaw);
    poses += sees_map ? 1 : 0;
    const Query query = world.See(truth, {.outlier_share = random.Uniform(0.0, 0.6)}, random);
    const auto answer = Localize(query, *Snapshot(world), {}, kNoDeadline, nullptr);
    ASSERT_TRUE(answer.ok()) << answer.status().ToString();
    if (answer->outcome != Outcome::kLocalized) continue;
    localized += sees_map ? 1 : 0;
    EXPECT_LT(PositionError(*answer, truth), 0.3) << "repetition " << repetition;
  }
  EXPECT_GE(localized, kPoses - 2);
}

TEST(LocalizationPropertyTest, TheOrderOfFeaturesDoesNotMatter) {
  Random random = testing::TestRandom();
  const DrawnWorld world(testing::TestRandom(1));
  const Rigid3 truth = DrawnWorld::CameraFromMapAt(14.0, -0.8);
  Query query = world.See(truth, {}, random);
  const auto snapshot = Snapshot(world);
  const auto forward = Localize(query, *snapshot, {}, kNoDeadline, nullptr);
  query.views[0].points = Reversed(query.views[0].points);
  const auto backward = Localize(query, *snapshot, {}, kNoDeadline, nullptr);
  ASSERT_TRUE(forward.ok() && backward.ok());
  ASSERT_EQ(forward->outcome, Outcome::kLocalized);
  ASSERT_EQ(backward->outcome, Outcome::kLocalized);
  EXPECT_EQ(forward->segment, backward->segment);
  EXPECT_EQ(forward->matches.points.size(), backward->matches.points.size());
  EXPECT_LT((forward->map_from_body->translation - backward->map_from_body->translation).norm(),
            0.01);
}

// Features without any truth in them must never be LOCALIZED.
TEST(LocalizationPropertyTest, ChanceIsNeverLocalized) {
  for (int repetition = 0; repetition < 30; ++repetition) {
    Random random = testing::TestRandom(repetition);
    const DrawnWorld world(random.Fork(1));
    const Rigid3 somewhere = DrawnWorld::CameraFromMapAt(random.Uniform(2, 30), 0.5);
    const Query query = world.See(somewhere, {.outlier_share = 1.0}, random);
    const auto answer = Localize(query, *Snapshot(world), {}, kNoDeadline, nullptr);
    ASSERT_TRUE(answer.ok());
    EXPECT_NE(answer->outcome, Outcome::kLocalized) << "repetition " << repetition;
  }
}

}  // namespace
}  // namespace maploc
