#include "server/trust/visibility.h"

#include <gtest/gtest.h>

namespace maploc {
namespace {

// A landmark at the origin, seen from 4 to 6 m along +x within 10 degrees.
const ViewingRange kSeenAlongX = {{1, 0, 0}, 0.1745f, 4, 6};

TEST(IsVisible, FromWhereTheMapSawIt) {
  EXPECT_TRUE(IsVisible(kSeenAlongX, Eigen::Vector3d::Zero(), {5, 0, 0}));
  EXPECT_TRUE(IsVisible(kSeenAlongX, Eigen::Vector3d::Zero(), {1, 2, 0}));
}

TEST(IsVisible, NotFromBehind) {
  EXPECT_FALSE(IsVisible(kSeenAlongX, Eigen::Vector3d::Zero(), {-5, 0, 0}));
  EXPECT_FALSE(IsVisible(kSeenAlongX, Eigen::Vector3d::Zero(), {-2, 4, 0}));  // 117 degrees
}

TEST(IsVisible, NotFromFarOutsideOfItsDistances) {
  EXPECT_FALSE(IsVisible(kSeenAlongX, Eigen::Vector3d::Zero(), {31, 0, 0}));
  EXPECT_FALSE(IsVisible(kSeenAlongX, Eigen::Vector3d::Zero(), {0.7, 0, 0}));
}

TEST(IsVisible, FromAnywhereWhereTheMapDoesNotSay) {
  EXPECT_TRUE(IsVisible(ViewingRange(), Eigen::Vector3d::Zero(), {-5, 0, 0}));
}

TEST(WithoutUnseen, KeepsTheInliersThatCanBeSeen) {
  PoseProblem problem;
  const ViewingRange from_behind = {{-1, 0, 0}, 0.1f, 4, 6};
  problem.points.resize(3);
  problem.points[0].viewing = kSeenAlongX;
  problem.points[1].viewing = from_behind;
  problem.lines.resize(1);
  problem.lines[0].segment_in_map = {{0, 0, -1}, {0, 0, 1}};
  problem.lines[0].viewing = from_behind;
  RefinedPose pose;
  pose.camera_from_map.translation = {-5, 0, 0};  // the centre is at x = 5
  pose.point_inliers = {1, 1, 1};
  pose.line_inliers = {1};
  const RefinedPose seen = WithoutUnseen(problem, pose);
  EXPECT_EQ(seen.point_inliers, (std::vector<std::uint8_t>{1, 0, 1}));
  EXPECT_EQ(seen.line_inliers, (std::vector<std::uint8_t>{0}));
}

}  // namespace
}  // namespace maploc
