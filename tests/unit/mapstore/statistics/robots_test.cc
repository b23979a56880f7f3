// Fleets made up: what each robot sees in each segment, its faults and the map's.
#include "mapstore/statistics/robots.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>

#include <gmock/gmock.h>

#include "tests/support/seed.h"

namespace maploc::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kSegments = 5;
constexpr double kDegree = 0.017453292519943295;

// What a fleet lives through. Times count sessions of the whole fleet.
struct Story {
  int robots = 6;
  int sessions_each = 6;
  int broken_imu = -1;           // this robot's gravity is 5 degrees off ...
  int broken_from = 0;           // ... from this session of it on
  int blurred_camera = -1;       // half of this robot's point inliers are lost
  int dying_segment = -1;        // its points fade from the middle of the story on
  bool dies_for_all = false;     // every segment's do
  double session_scatter = 1.0;  // light, traffic: how much sessions differ
};

// A session that holds what it saw.
struct ToldSession {
  SessionId session;
  std::string robot;
  std::int64_t start_unix_ns = 0;
  std::vector<Observation> observations;
};

FleetComparison Compare(const std::vector<ToldSession>& told) {
  std::vector<RobotSession> sessions;
  for (const ToldSession& s : told) {
    sessions.push_back({s.session, s.robot, s.start_unix_ns, s.observations});
  }
  return CompareRobots(sessions);
}

Observation Query(Random& random, int sequence, SegmentId segment, double ratio,
                  double gravity_rad) {
  Observation o;
  o.sequence = sequence;
  o.segment = segment;
  o.outcome = random.Uniform() < 0.9 ? Outcome::kLocalized : Outcome::kNoConsensus;
  o.evidence.points = {100, static_cast<int>(100 * std::clamp(ratio, 0.02, 1.0))};
  o.evidence.usable_lines = {
      20, static_cast<int>(20 * std::clamp(0.5 + random.Gaussian(0.1), 0.0, 1.0))};
  if (o.outcome == Outcome::kLocalized) {
    const double x = random.Gaussian(0.5 * kDegree);
    const double y = gravity_rad + random.Gaussian(0.5 * kDegree);
    o.evidence.gravity_disagreement_rad = std::hypot(x, y);
  }
  return o;
}

std::string NameOf(int robot) { return "r" + std::to_string(robot); }

std::vector<ToldSession> Tell(const Story& story, Random& random) {
  std::vector<ToldSession> sessions;
  for (int s = 0; s < story.sessions_each; ++s) {
    for (int robot = 0; robot < story.robots; ++robot) {
      const int time = s * story.robots + robot;
      ToldSession session{NameOf(robot) + "-" + std::to_string(s), NameOf(robot), time, {}};
      const double light = random.Gaussian(0.05 * story.session_scatter);
      const bool late = s >= story.sessions_each / 2;
      const bool tilted = robot == story.broken_imu && s >= story.broken_from;
      int sequence = 0;
      for (SegmentId segment = 0; segment < kSegments; ++segment) {
        const bool dead = late && (segment == story.dying_segment || story.dies_for_all);
        double ratio = (dead ? 0.1 : 0.3 + 0.1 * segment) + light;
        if (robot == story.blurred_camera) ratio *= 0.5;
        for (int q = 0; q < 8; ++q) {
          session.observations.push_back(Query(random, ++sequence, segment,
                                               ratio + random.Gaussian(0.08),
                                               tilted ? 5.0 * kDegree : 0.0));
        }
      }
      sessions.push_back(std::move(session));
    }
  }
  return sessions;
}

std::vector<std::string> FlaggedRobots(const FleetComparison& fleet) {
  std::vector<std::string> flagged;
  for (const RobotComparison& robot : fleet.robots) {
    for (const RobotDifference& d : robot.differences) {
      if (d.stands_out)
        flagged.push_back(robot.robot + " " + std::string(RobotMetricName(d.metric)));
    }
  }
  return flagged;
}

std::vector<std::string> FlaggedSessions(const FleetComparison& fleet) {
  std::vector<std::string> flagged;
  for (const SessionComparison& session : fleet.sessions) {
    if (session.StandsOut()) flagged.push_back(session.session);
  }
  return flagged;
}

// What fleets that are told the same story flag.
struct Flagged {
  int without_robot = 0;  // fleets that miss a robot at fault
  int without_session = 0;
  int false_robot = 0;  // fleets that flag a robot, or a metric of it, without a fault
  int false_session = 0;
};

using Names = std::vector<std::string>;

bool HasAll(const Names& flagged, const Names& at_fault) {
  return std::all_of(at_fault.begin(), at_fault.end(), [&](const std::string& name) {
    return std::count(flagged.begin(), flagged.end(), name) > 0;
  });
}

constexpr int kFleets = 1000;

Flagged Count(const Story& story, const Names& robots_at_fault, const Names& sessions_at_fault) {
  Flagged count;
  for (int repetition = 0; repetition < kFleets; ++repetition) {
    Random random = TestRandom(repetition);
    const FleetComparison fleet = Compare(Tell(story, random));
    const Names robots = FlaggedRobots(fleet);
    const Names sessions = FlaggedSessions(fleet);
    count.without_robot += HasAll(robots, robots_at_fault) ? 0 : 1;
    count.without_session += HasAll(sessions, sessions_at_fault) ? 0 : 1;
    count.false_robot += HasAll(robots_at_fault, robots) ? 0 : 1;
    count.false_session += HasAll(sessions_at_fault, sessions) ? 0 : 1;
  }
  return count;
}

// The promise is 1% of fleets, for robots and for sessions alike: 10 of 1000. 29 or more have a
// probability of 6e-7 (binomial).
constexpr int kTooManyOf1Percent = 29;
// Of one in a thousand: 10 or more of 1000 have a probability of 1e-7.
constexpr int kTooManyOf1Permille = 10;

Names SessionsOf(const std::string& robot, int first, int last) {
  Names names;
  for (int s = first; s <= last; ++s) names.push_back(robot + "-" + std::to_string(s));
  return names;
}

// Five degrees are twelve standard deviations and more of a quarter of a degree, so that every
// fleet tells.
TEST(Robots, ABrokenImuIsFlaggedAmongFiveHealthyOnes) {
  const Flagged count = Count({.broken_imu = 2}, {"r2 gravity"}, SessionsOf("r2", 0, 5));
  EXPECT_EQ(count.without_robot, 0);
  EXPECT_EQ(count.without_session, 0);
  EXPECT_LT(count.false_robot, kTooManyOf1Percent);
  EXPECT_LT(count.false_session, kTooManyOf1Percent);
  for (int repetition = 0; repetition < 20; ++repetition) {
    Random random = TestRandom(repetition);
    const FleetComparison fleet = Compare(Tell({.broken_imu = 2}, random));
    const RobotDifference& gravity = fleet.robots[2].differences.front();
    EXPECT_NEAR(gravity.own, 5.0 * kDegree, 0.5 * kDegree);
    EXPECT_LT(gravity.others, 1.5 * kDegree);
  }
}

// Its older sessions were good, so the robot as a whole does not stand out; the sessions do.
TEST(Robots, AnImuThatBrokeYesterdayIsFlaggedInTheSessionsSince) {
  const Flagged count = Count({.broken_imu = 4, .broken_from = 4}, {}, SessionsOf("r4", 4, 5));
  EXPECT_EQ(count.without_session, 0);
  EXPECT_LT(count.false_robot, kTooManyOf1Percent);
  EXPECT_LT(count.false_session, kTooManyOf1Percent);
}

// Half of its point inliers, a quarter of all, is lost: six to seven standard deviations of a
// robot's median over six sessions, of which four are needed. One fleet in a thousand may miss it.
TEST(Robots, ABlurredCameraShowsInItsPoints) {
  const Flagged count = Count({.blurred_camera = 1}, {"r1 points"}, SessionsOf("r1", 0, 5));
  EXPECT_LT(count.without_robot, kTooManyOf1Permille);
  EXPECT_LT(count.false_robot, kTooManyOf1Percent);
  EXPECT_LT(count.false_session, kTooManyOf1Percent);
}

TEST(Robots, ADyingSegmentIsNobodysFault) {
  const Flagged count = Count({.dying_segment = 3}, {}, {});
  EXPECT_LT(count.false_robot, kTooManyOf1Percent);
  EXPECT_LT(count.false_session, kTooManyOf1Percent);
}

// Nor a session's: the one that is driven when it dies is worse than those before, and no worse
// than those after.
TEST(Robots, ADyingMapIsNobodysFault) {
  const Flagged count = Count({.dies_for_all = true}, {}, {});
  EXPECT_LT(count.false_robot, kTooManyOf1Percent);
  EXPECT_LT(count.false_session, kTooManyOf1Percent);
}

// However few robots and sessions the scatter is estimated from.
TEST(Robots, HealthyFleetsAreRarelyFlagged) {
  for (const auto& [robots, sessions] : {std::pair{6, 6}, {6, 3}, {2, 6}}) {
    for (const double scatter : {1.0, 3.0}) {
      const Flagged count =
          Count({.robots = robots, .sessions_each = sessions, .session_scatter = scatter}, {}, {});
      EXPECT_LT(count.false_robot, kTooManyOf1Percent)
          << robots << " robots, " << sessions << " sessions each, scatter " << scatter;
      EXPECT_LT(count.false_session, kTooManyOf1Percent)
          << robots << " robots, " << sessions << " sessions each, scatter " << scatter;
    }
  }
}

TEST(Robots, OneRobotAloneOrRobotsApartCannotBeCompared) {
  Random random = TestRandom();
  std::vector<ToldSession> sessions = Tell({.broken_imu = 0}, random);
  std::erase_if(sessions, [](const ToldSession& s) { return s.robot != "r0"; });
  const FleetComparison alone = Compare(sessions);
  ASSERT_EQ(alone.robots.size(), 1u);
  EXPECT_EQ(alone.robots[0].sessions, Story().sessions_each);
  EXPECT_THAT(alone.robots[0].differences, IsEmpty());
  ToldSession elsewhere = sessions.front();
  elsewhere.robot = "far";
  for (Observation& o : elsewhere.observations) o.segment += 100;
  sessions.push_back(elsewhere);
  EXPECT_THAT(FlaggedRobots(Compare(sessions)), IsEmpty());
  EXPECT_THAT(Compare({}).robots, IsEmpty());
}

// Of one robot, which nobody is compared with.
TEST(Robots, ACalibrationIsOffInMostQueriesOfThreeAtLeast) {
  const auto is_off = [](int contradicted, int queries) {
    ToldSession session{"s", "r", 0, {}};
    for (int i = 0; i < queries; ++i) {
      Observation query;
      query.outcome = i < contradicted ? Outcome::kCalibrationInconsistent : Outcome::kLocalized;
      session.observations.push_back(query);
    }
    const FleetComparison fleet = Compare({session});
    EXPECT_EQ(fleet.robots[0].calibration_inconsistent, contradicted);
    return fleet.robots[0].CalibrationIsOff();
  };
  EXPECT_FALSE(is_off(0, 0));
  EXPECT_FALSE(is_off(2, 2));
  EXPECT_TRUE(is_off(3, 3));
  EXPECT_FALSE(is_off(3, 6));
  EXPECT_TRUE(is_off(4, 7));
}

TEST(Robots, GravityIsOffWhereMostQueriesContradictItLocalizedWithoutOrNotAtAll) {
  ToldSession session{"s", "r", 0, std::vector<Observation>(5)};
  session.observations[0].evidence.gravity_rejected = true;
  session.observations[1].outcome = Outcome::kGravityInconsistent;
  EXPECT_FALSE(Compare({session}).robots[0].GravityIsOff());
  session.observations[2].evidence.gravity_rejected = true;
  EXPECT_EQ(Compare({session}).robots[0].gravity_rejected, 3);
  EXPECT_TRUE(Compare({session}).robots[0].GravityIsOff());
}

TEST(Robots, OfTwoRobotsTheWorseOneIsFlagged) {
  Random random = TestRandom();
  std::vector<ToldSession> sessions = Tell({.broken_imu = 0}, random);
  std::erase_if(sessions, [](const ToldSession& s) { return s.robot > "r1"; });
  EXPECT_THAT(FlaggedRobots(Compare(sessions)), ElementsAre("r0 gravity"));
}

// One segment, few moments, so that many sessions are equally near; a robot may have most of them.
std::vector<ToldSession> RandomFleet(Random& random) {
  std::vector<ToldSession> sessions;
  const std::uint32_t count = 2 + random.Below(40);
  const std::uint32_t moments = 1 + random.Below(60);
  const double share_of_first = random.Uniform();
  for (std::uint32_t i = 0; i < count; ++i) {
    const int robot = random.Uniform() < share_of_first ? 0 : static_cast<int>(random.Below(5));
    ToldSession session{"s" + std::to_string(i), NameOf(robot), random.Below(moments), {}};
    for (int q = 1; q <= 6; ++q) session.observations.push_back(Query(random, q, 0, 0.5, 0.0));
    sessions.push_back(std::move(session));
  }
  return sessions;
}

double SuccessOf(const ToldSession& session) {
  const auto localized =
      std::count_if(session.observations.begin(), session.observations.end(),
                    [](const Observation& o) { return o.outcome == Outcome::kLocalized; });
  return static_cast<double>(localized) / static_cast<double>(session.observations.size());
}

// The median of the nearest others', all of them sorted by distance in time and value.
std::optional<double> OthersByDefinition(const std::vector<ToldSession>& sessions,
                                         const ToldSession& own) {
  std::vector<std::pair<std::int64_t, double>> others;
  for (const ToldSession& s : sessions) {
    if (s.robot == own.robot) continue;
    others.emplace_back(std::abs(s.start_unix_ns - own.start_unix_ns), SuccessOf(s));
  }
  if (others.empty()) return std::nullopt;
  std::sort(others.begin(), others.end());
  constexpr std::size_t kNearest = 10;  // robots.h
  others.resize(std::min(others.size(), kNearest));
  std::vector<double> values;
  for (const auto& [distance, value] : others) values.push_back(value);
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle] + values[middle - 1]);
}

TEST(Robots, AreSetBesideTheNearestSessionsOfOthers) {
  for (int repetition = 0; repetition < 500; ++repetition) {
    Random random = TestRandom(repetition);
    const std::vector<ToldSession> sessions = RandomFleet(random);
    const FleetComparison fleet = Compare(sessions);
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      std::optional<double> others;
      for (const RobotDifference& d : fleet.sessions[i].differences) {
        if (d.metric == RobotMetric::kSuccess) others = d.others;
      }
      ASSERT_EQ(others, OthersByDefinition(sessions, sessions[i])) << TestSeed(repetition);
    }
  }
}

}  // namespace
}  // namespace maploc::testing
