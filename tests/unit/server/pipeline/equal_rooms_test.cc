// Places that look the same in one map.
#include <gtest/gtest.h>

#include "server/pipeline/localizer.h"
#include "tests/support/drawn_world.h"
#include "tests/support/resident_map.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using testing::DrawnWorld;

// The world and, `away` metres on, its equal: of each segment a copy with landmarks of its own.
// `share` of the copies' points look like the originals'.
std::shared_ptr<const MapSnapshot> SnapshotWithTwins(const DrawnWorld& world, double share,
                                                     Random& random, double away = 100.0) {
  std::vector<MapSnapshot::Entry> entries;
  for (const auto& segment : world.segments()) entries.push_back({segment, {}});
  for (const auto& original : world.segments()) {
    auto twin = std::make_shared<Segment>(*original);
    twin->id = static_cast<SegmentId>(entries.size());
    PointLandmarks& points = twin->points;
    for (auto& id : points.ids) id += 1'000'000;
    for (auto& id : twin->lines.ids) id += 1'000'000;
    for (auto& position : points.positions_in_map) position.x() += away;
    for (auto& line : twin->lines.segments_in_map) {
      line.start.x() += away;
      line.end.x() += away;
    }
    for (auto& position : twin->path_in_map) position.x() += away;
    const std::size_t width = static_cast<std::size_t>(points.descriptors.kind.bytes);
    for (std::size_t i = 0; i < points.descriptors.bytes.size(); i += width) {
      if (random.Uniform() < share) continue;
      for (std::size_t b = i; b < i + width; ++b) {
        points.descriptors.bytes[b] = static_cast<std::uint8_t>(random.Below(256));
      }
    }
    entries.push_back({twin, {}});
  }
  return testing::ResidentMap(world.info(), entries).value();
}

class EqualRooms : public ::testing::Test {
 protected:
  Query Look() { return world_.See(camera_from_map_, {}, random_); }

  Random random_ = testing::TestRandom();
  DrawnWorld world_{testing::TestRandom(1)};
  Rigid3 camera_from_map_ = DrawnWorld::CameraFromMapAt(16.0, 0.6);
};

// Equal rooms of a hotel: whoever sees nothing else cannot be told which of them this is.
TEST_F(EqualRooms, OneOfTwoIsNotGuessed) {
  for (int i = 0; i < 10; ++i) {
    const auto answer =
        Localize(Look(), *SnapshotWithTwins(world_, 1.0, random_), {}, kNoDeadline, nullptr);
    ASSERT_TRUE(answer.ok());
    EXPECT_EQ(answer->outcome, Outcome::kLowConfidence);
  }
}

TEST_F(EqualRooms, OneThatDiffersInMostIsTold) {
  for (int i = 0; i < 10; ++i) {
    const auto answer =
        Localize(Look(), *SnapshotWithTwins(world_, 0.1, random_), {}, kNoDeadline, nullptr);
    ASSERT_TRUE(answer.ok());
    ASSERT_EQ(answer->outcome, Outcome::kLocalized);
    const Eigen::Vector3d truth = camera_from_map_.Inverse().translation;
    EXPECT_LT((answer->map_from_body->translation - truth).norm(), 0.05);
  }
}

// Two drives through one street without loops closed between them: each has its own landmarks.
TEST_F(EqualRooms, APlaceThatWasMappedTwiceIsTold) {
  for (int i = 0; i < 10; ++i) {
    const auto answer =
        Localize(Look(), *SnapshotWithTwins(world_, 1.0, random_, 0.03), {}, kNoDeadline, nullptr);
    ASSERT_TRUE(answer.ok());
    EXPECT_EQ(answer->outcome, Outcome::kLocalized);
  }
}

}  // namespace
}  // namespace maploc
