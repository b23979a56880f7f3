#include "mapstore/tools/lean_warning.h"

#include <gmock/gmock.h>

namespace maploc {
namespace {

SeenSession Drive(const std::string& robot, const Eigen::Vector2d& tilt_rad) {
  SeenSession seen;
  seen.session.id = robot;
  seen.session.map = {"yard", 3};
  seen.session.robot = robot;
  for (int i = 0; i < 10; ++i) {
    Observation observation;
    observation.outcome = Outcome::kLocalized;
    observation.evidence.gravity_tilt_rad = tilt_rad + Eigen::Vector2d(0.001 * (i % 3), 0);
    observation.evidence.gravity_disagreement_rad = observation.evidence.gravity_tilt_rad.norm();
    seen.observations.push_back(observation);
  }
  return seen;
}

TEST(DescribeLeans, TellsWhatAllRobotsSay) {
  const std::vector<std::string> lines = DescribeLeans(
      {Drive("a", {0.06, 0.0}), Drive("b", {0.062, 0.001}), Drive("c", {0.058, -0.001})});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], testing::HasSubstr("map yard: gravity of version 3 is off by 3."));
  EXPECT_THAT(lines[0], testing::HasSubstr("maploc-map level --map yard --gravity "));
}

TEST(DescribeLeans, SaysNothingOfOneRobotsMounting) {
  EXPECT_THAT(DescribeLeans({Drive("a", {0.06, 0.0}), Drive("b", {0.001, 0.001})}),
              testing::IsEmpty());
}

TEST(DescribeLeans, LeavesRevokedSessionsOut) {
  std::vector<SeenSession> sessions = {Drive("a", {0.06, 0.0}), Drive("b", {0.06, 0.0})};
  sessions[1].session.revoked = true;
  EXPECT_THAT(DescribeLeans(sessions), testing::IsEmpty());
}

}  // namespace
}  // namespace maploc
