#include "mapstore/statistics/lean.h"

#include <numbers>

#include <gtest/gtest.h>

#include "mapstore/geometry/gravity.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A robot in a map that leans, mounted askew by `mount` and with a degree of noise in each query.
RobotTilts Drive(const std::string& name, const Eigen::Vector2d& lean_deg,
                 const Eigen::Vector2d& mount_deg, int queries, Random& random) {
  RobotTilts robot{name, {}};
  for (int i = 0; i < queries; ++i) {
    const Eigen::Vector2d noise(random.Gaussian(), random.Gaussian());
    robot.tilts_rad.push_back((lean_deg + mount_deg + noise) * kDegree);
  }
  return robot;
}

Eigen::Vector2d Mount(Random& random) { return {random.Gaussian(0.5), random.Gaussian(0.5)}; }

// By the contract a robot acquits the map whose own mounting takes it nearer to zero than to the
// mean: by half of the lean, 1.80 degrees. Of four robots x_k - mean / 2 has a standard deviation
// of sqrt(0.8125) times 0.54 degrees (the mounting's 0.5 and the median's 0.2), so this is 3.72 of
// them: four times 1e-4, one fleet in 2500. Of 4000 fleets 12 or more have a probability of 1.3e-7.
// The truth may be outside the interval in 5 of 100; 270 or more of 4000 have one of 7.6e-7.
TEST(FindLean, RobotsThatDisagreeTheSameWayMakeAMapThatLeans) {
  Random random = testing::TestRandom();
  int missed = 0;
  int outside = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector2d truth(3, -2);
    std::vector<RobotTilts> robots;
    for (const char* name : {"a", "b", "c", "d"}) {
      robots.push_back(Drive(name, truth, Mount(random), 40, random));
    }
    const Lean lean = FindLean(robots);
    missed += lean.leans ? 0 : 1;
    EXPECT_EQ(lean.robots, 4);
    EXPECT_EQ(lean.queries, 160);
    outside += (lean.tilt_rad - truth * kDegree).norm() < lean.interval_rad ? 0 : 1;
  }
  EXPECT_LT(missed, 12);
  EXPECT_LT(outside, 270);
}

// Four that lean by 3.6 degrees, and one that agrees with the map: its own mounting cannot be wrong
// by the same lean and the other way.
TEST(FindLean, OneRobotThatAgreesWithTheMapAcquitsIt) {
  Random random = testing::TestRandom();
  std::vector<RobotTilts> robots;
  for (const char* name : {"a", "b", "c", "d"}) {
    robots.push_back(Drive(name, {3, -2}, {0, 0}, 40, random));
  }
  EXPECT_TRUE(FindLean(robots).leans);
  robots.push_back(Drive("level", {0, 0}, {0, 0}, 40, random));
  EXPECT_FALSE(FindLean(robots).leans);
}

// One level map in ten thousand may be accused, by few robots with few queries as by others: 2
// expected of 20,000; 10 or more have a probability of one in 20,000.
TEST(FindLean, AMapThatIsLevelDoesNot) {
  constexpr int kFleets = 20000;
  for (const int queries : {5, 40}) {
    Random random = testing::TestRandom(queries);
    int accused = 0;
    for (int i = 0; i < kFleets; ++i) {
      std::vector<RobotTilts> robots;
      for (const char* name : {"a", "b", "c"}) {
        robots.push_back(Drive(name, {0, 0}, Mount(random), queries, random));
      }
      accused += FindLean(robots).leans ? 1 : 0;
    }
    EXPECT_LT(accused, 10) << queries << " queries a robot";
  }
}

TEST(FindLean, OneRobotThatIsMountedAskewAccusesNoMap) {
  Random random = testing::TestRandom();
  const RobotTilts askew = Drive("askew", {0, 0}, {8, 0}, 400, random);
  const RobotTilts level = Drive("level", {0, 0}, {0, 0}, 40, random);
  const RobotTilts brief = Drive("brief", {8, 0}, {0, 0}, 2, random);
  EXPECT_FALSE(FindLean(std::vector{askew}).leans);
  EXPECT_FALSE(FindLean(std::vector{askew, level}).leans);
  EXPECT_FALSE(FindLean(std::vector{askew, brief}).leans) << "two queries are no second voice";
  EXPECT_EQ(FindLean({}).robots, 0);
}

TEST(FindLean, ASmallLeanIsNobodysConcern) {
  Random random = testing::TestRandom();
  std::vector<RobotTilts> robots;
  for (int i = 0; i < 50; ++i) {
    robots.push_back(Drive(std::to_string(i), {0.7, 0}, Mount(random), 40, random));
  }
  const Lean lean = FindLean(robots);
  EXPECT_FALSE(lean.leans);
  EXPECT_NEAR(lean.tilt_rad.x(), 0.7 * kDegree, 0.3 * kDegree);
}

// Robots that measure down as (0.1, 0, -1) in the map's frame: it leans about y.
TEST(GravityOfLean, IsWhatTheRobotsMeasured) {
  const Eigen::Vector3d measured = Eigen::Vector3d(0.1, 0, -1).normalized();
  const double angle = AngleBetween(kGravityInMap, measured);
  EXPECT_LT((GravityOfLean({0, -angle}) - measured).norm(), 1e-12);
  EXPECT_EQ(GravityOfLean({0, 0}), kGravityInMap);
}

}  // namespace
}  // namespace maploc
