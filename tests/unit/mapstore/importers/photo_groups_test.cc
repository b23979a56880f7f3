#include "mapstore/importers/photo_groups.h"

#include <set>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/unit/mapstore/importers/drawn_scene.h"

namespace maploc {
namespace {

// Sees what is within 5 m of it.
std::vector<PointTrack> SeenNear(const std::vector<KeyFrame>& frames, int count, Random& random) {
  std::vector<PointTrack> points;
  for (int i = 0; i < count; ++i) {
    PointTrack point;
    const auto& near = frames[random.Below(static_cast<std::uint32_t>(frames.size()))];
    point.position_in_map =
        near.CenterInMap() + Eigen::Vector3d(random.Uniform(-3, 3), random.Uniform(-3, 3), 0);
    for (std::size_t f = 0; f < frames.size(); ++f) {
      if ((frames[f].CenterInMap() - point.position_in_map).norm() < 5.0) {
        point.frames.push_back(static_cast<std::int32_t>(f));
      }
    }
    points.push_back(point);
  }
  return points;
}

std::set<int> AsSet(const std::vector<int>& group) { return {group.begin(), group.end()}; }

TEST(GroupPhotosTest, PhotosOfOnePlaceStandTogetherHoweverTheyAreNamed) {
  Random random = testing::TestRandom();
  std::vector<KeyFrame> frames;
  for (int i = 0; i < 30; ++i) {  // in turn at three places
    frames.push_back(
        testing::MakeFrame(i, {50.0 * (i % 3) + random.Uniform(-2, 2), random.Uniform(-2, 2), 1}));
  }
  const auto groups = GroupPhotos(frames, SeenNear(frames, 500, random), 20.0);
  ASSERT_EQ(groups.size(), 3u);
  for (const auto& group : groups) {
    EXPECT_EQ(group.size(), 10u);
    for (const int frame : group) EXPECT_EQ(frame % 3, group.front() % 3);
  }
}

// Two fronts of one house see nothing in common, although photos of both are taken at its corner.
TEST(GroupPhotosTest, NearPhotosThatShareNothingAreApart) {
  const std::vector<KeyFrame> frames = {
      testing::MakeFrame(0, {0, 0, 1}), testing::MakeFrame(1, {1, 0, 1}),
      testing::MakeFrame(2, {0, 0.1, 1}), testing::MakeFrame(3, {1, 0.1, 1})};
  const std::vector<PointTrack> points = {{{0, 5, 0}, {0, 1}, {}}, {{0, -5, 0}, {2, 3}, {}}};
  EXPECT_THAT(
      GroupPhotos(frames, points, 10.0),
      ::testing::UnorderedElementsAre(::testing::ElementsAre(0, 1), ::testing::ElementsAre(2, 3)));
}

TEST(GroupPhotosTest, EveryPhotoIsInOneGroupAndNoGroupIsTooWide) {
  Random random = testing::TestRandom();
  for (int repetition = 0; repetition < 20; ++repetition) {
    std::vector<KeyFrame> frames;
    const int count = 1 + static_cast<int>(random.Below(60));
    for (int i = 0; i < count; ++i) {
      frames.push_back(testing::MakeFrame(i, {random.Uniform(0, 60), random.Uniform(0, 60), 1}));
    }
    const double extent = random.Uniform(1, 100);
    std::set<int> all;
    std::size_t sum = 0;
    for (const auto& group : GroupPhotos(frames, SeenNear(frames, 300, random), extent)) {
      Eigen::AlignedBox3d box;
      for (const int frame : group) box.extend(frames[frame].CenterInMap());
      EXPECT_LE(box.diagonal().norm(), extent);
      all.merge(AsSet(group));
      sum += group.size();
    }
    EXPECT_EQ(all.size(), frames.size());
    EXPECT_EQ(sum, frames.size());
  }
}

}  // namespace
}  // namespace maploc
