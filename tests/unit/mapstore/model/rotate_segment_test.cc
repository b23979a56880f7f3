#include "mapstore/model/rotate_segment.h"

#include <numbers>

#include <gtest/gtest.h>

namespace maploc {
namespace {

TEST(RotateSegment, TurnsEverythingThatHasAPlace) {
  Segment segment;
  segment.id = 3;
  segment.path_in_map = {{1, 0, 0}};
  segment.points.ids = {7};
  segment.points.positions_in_map = {{0, 2, 0}};
  segment.lines.ids = {8};
  segment.lines.segments_in_map = {{{0, 0, 3}, {1, 0, 3}}};
  // A quarter turn about z: x becomes y, y becomes -x.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));
  const Segment turned = RotateSegment(turn, segment);
  EXPECT_EQ(turned.id, 3);
  EXPECT_LT((turned.path_in_map[0] - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  EXPECT_LT((turned.points.positions_in_map[0] - Eigen::Vector3d(-2, 0, 0)).norm(), 1e-12);
  EXPECT_LT((turned.lines.segments_in_map[0].start - Eigen::Vector3d(0, 0, 3)).norm(), 1e-12);
  EXPECT_LT((turned.lines.segments_in_map[0].end - Eigen::Vector3d(0, 1, 3)).norm(), 1e-12);
  EXPECT_EQ(turned.points.ids, segment.points.ids);
}

}  // namespace
}  // namespace maploc
