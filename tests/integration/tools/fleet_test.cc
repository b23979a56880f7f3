// What robots, sessions and stats tell of the robots: whose gravity or calibration is off, and
// whether it is the map.
#include "tests/integration/tools/maploc_map_fixture.h"

namespace maploc::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

// Three robots drive the yard; the gravity of one is five degrees off.
TEST_F(MaplocMap, ARobotThatStandsOutIsNamedByRobotsAndBySessions) {
  // The fixture's session saw other things.
  ASSERT_TRUE(OpenSqliteStore(store_).value()->RevokeSession("s").ok());
  for (const std::string robot : {"good", "fine", "tilted"}) {
    std::vector<Observation> seen;
    for (int i = 1; i <= 12; ++i) {
      seen.push_back(Seen(i, i % 3));
      seen.back().evidence.gravity_disagreement_rad = robot == "tilted" ? 0.087 : 0.01;
    }
    for (int drive = 0; drive < 3; ++drive) {
      Drive(robot + std::to_string(drive), robot, seen, 5000 + drive);
    }
  }
  const json robots = Json("robots --store $STORE --map yard");
  ASSERT_EQ(robots.size(), 4u);  // and r2 of the fixture
  for (const json& robot : robots) {
    EXPECT_EQ(robot.at("stands_out"), robot.at("robot") == "tilted") << robot;
  }
  EXPECT_EQ(robots[3].at("differences")[0].at("metric"), "gravity");
  EXPECT_DOUBLE_EQ(robots[3].at("differences")[0].at("own"), 0.087);
  EXPECT_DOUBLE_EQ(robots[3].at("differences")[0].at("others"), 0.01);
  const std::string flag = "gravity 5.0 (others 0.6) degrees";
  EXPECT_THAT(Map("robots --store $STORE --map yard").out, HasSubstr(flag));
  for (const json& session : Json("sessions --store $STORE")) {
    EXPECT_EQ(session.at("stands_out"), session.at("robot") == "tilted") << session;
  }
  EXPECT_THAT(Map("sessions --store $STORE").out, HasSubstr(flag));
  ExpectFails("robots --store $STORE --map yard --version 2", "map 'yard' version 2");
}

// One robot's camera is not the one that it says, which its matches tell without any other robot.
TEST_F(MaplocMap, ARobotWhoseCalibrationIsOffIsToldWhyAndWhatToDo) {
  std::vector<Observation> seen;
  for (int i = 1; i <= 12; ++i) {
    seen.push_back(Seen(i, 1));
    if (i <= 9) seen.back().outcome = Outcome::kCalibrationInconsistent;
  }
  Drive("zoomed0", "zoomed", seen);
  const std::string command = "robots --store $STORE --map yard";
  const json robots = Json(command);
  ASSERT_EQ(robots.size(), 2u);  // and r2 of the fixture
  EXPECT_EQ(robots[0].at("calibration_inconsistent"), 0);
  EXPECT_EQ(robots[0].at("calibration_inconsistent_share"), 0.0);
  EXPECT_EQ(robots[0].at("calibration_remark"), nullptr);
  EXPECT_EQ(robots[1].at("calibration_inconsistent"), 9);
  EXPECT_EQ(robots[1].at("calibration_inconsistent_share"), 0.75);
  const std::string remark = robots[1].at("calibration_remark");
  EXPECT_THAT(remark, HasSubstr("9 of its 12 queries contradict the camera calibration"));
  EXPECT_THAT(remark, HasSubstr("calibrate the camera again, with pictures as they are sent"));
  const std::string text = Map(command).out;
  EXPECT_THAT(text, HasSubstr("9 (0.750)"));
  EXPECT_THAT(text, HasSubstr("zoomed: " + remark + ".\n"));
  EXPECT_THAT(text, ::testing::Not(::testing::ContainsRegex("r2: [^\n]*calibration")));
}

TEST_F(MaplocMap, ARobotWhoseGravityIsRejectedIsToldWhyAndWhatToDo) {
  std::vector<Observation> seen;
  for (int i = 1; i <= 12; ++i) {
    seen.push_back(Seen(i, 1));
    seen.back().evidence.gravity_rejected = i <= 10;
  }
  Drive("turned0", "turned", seen);
  const json robot = Json("robots --store $STORE --map yard")[1];
  EXPECT_EQ(robot.at("gravity_rejected"), 10);
  const std::string remark = robot.at("gravity_remark");
  EXPECT_THAT(remark, HasSubstr("10 of its 12 queries contradict the gravity"));
  const std::string text = Map("robots --store $STORE --map yard").out;
  EXPECT_THAT(text, HasSubstr("10 (0.833)"));
  EXPECT_THAT(text, HasSubstr("turned: " + remark + ".\n"));
}

// Two robots' gravity disagrees with the map's by the same 3.4 degrees.
TEST_F(MaplocMap, AMapThatLeansIsToldByStatsAndBySessions) {
  // The fixture's session saw other things.
  ASSERT_TRUE(OpenSqliteStore(store_).value()->RevokeSession("s").ok());
  std::vector<Observation> seen;
  for (int i = 1; i <= 12; ++i) {
    seen.push_back(Seen(i, 1));
    seen.back().evidence.gravity_disagreement_rad = 0.06;
    seen.back().evidence.gravity_tilt_rad = {0.06, 0.0};
  }
  for (const std::string robot : {"one", "other"}) Drive(robot, robot, seen);
  for (const std::string command : {"stats --store $STORE --map yard", "sessions --store $STORE"}) {
    const Output run = Map(command + " --json");
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_FALSE(json::parse(run.out, nullptr, false).is_discarded()) << run.out;
    EXPECT_THAT(run.error, HasSubstr("map yard: gravity of version 1 is off by 3.4 degrees"));
    EXPECT_THAT(run.error, HasSubstr("maploc-map level --map yard --gravity "));
  }
  GiveMap(*OpenSqliteStore(store_).value());
  EXPECT_EQ(Map("stats --store $STORE --map yard").error, "");  // nobody drove the new version yet
}

}  // namespace
}  // namespace maploc::testing
