#include "server/trust/clumps.h"

#include <gtest/gtest.h>

namespace maploc::testing {
namespace {

std::vector<Eigen::Vector2d> Grid(int columns, int rows, double step, double left) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < columns * rows; ++i) {
    points.emplace_back(left + step * (i % columns), step * (i / columns));
  }
  return points;
}

TEST(CountByClumps, TwoOfASmallClumpAllOfAWideOneAndWhatStandsAlone) {
  EXPECT_EQ(CountByClumps({}, 2, 10), 0);
  std::vector<Eigen::Vector2d> points = Grid(4, 4, 1.5, 0);  // 6.4 across
  EXPECT_EQ(CountByClumps(points, 2, 10), 2);
  EXPECT_EQ(CountByClumps(points, 2, 6), 16) << "wider than 6";
  EXPECT_EQ(CountByClumps(points, 1, 10), 16) << "each further than 1 from all others";
  points.emplace_back(40, 0);
  for (const auto& point : Grid(3, 2, 1.5, 60)) points.push_back(point);
  EXPECT_EQ(CountByClumps(points, 2, 10), 2 + 1 + 2);
  std::reverse(points.begin(), points.end());
  EXPECT_EQ(CountByClumps(points, 2, 10), 2 + 1 + 2) << "in any order";
}

TEST(CountByClumps, AChainIsOneClump) {
  std::vector<Eigen::Vector2d> points;
  for (const double x : {0.0, 3.0, 1.5, 6.0, 4.5}) points.emplace_back(x, 0.5 * x);
  EXPECT_EQ(CountByClumps(points, 2, 7), 2);
  EXPECT_EQ(CountByClumps(points, 2, 6), 5);
}

TEST(CountByClumps, WithNoWidthEveryPointCounts) {
  EXPECT_EQ(CountByClumps(Grid(5, 5, 1, 0), 0, 0), 25);
}

}  // namespace
}  // namespace maploc::testing
