#include "mapstore/importers/landmark_views.h"

#include <gtest/gtest.h>

#include "tests/unit/mapstore/importers/drawn_scene.h"

namespace maploc {
namespace {

TEST(ViewingFromFramesTest, TakesTheFramesThatSawIt) {
  const std::vector<KeyFrame> frames = {testing::MakeFrame(0, {0, -8, 1}),
                                        testing::MakeFrame(1, {5, -8, 1}),
                                        testing::MakeFrame(2, {0, -6, 1})};
  const std::vector<std::int32_t> seen_by = {0, 2};
  const ViewingRange range = ViewingFromFrames({0, 0, 1}, frames, seen_by);
  EXPECT_LT((range.toward_cameras_in_map - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6f);
  EXPECT_NEAR(range.max_angle_rad, 0, 1e-6);
  EXPECT_FLOAT_EQ(range.min_distance, 6.0f);
  EXPECT_FLOAT_EQ(range.max_distance, 8.0f);
}

}  // namespace
}  // namespace maploc
