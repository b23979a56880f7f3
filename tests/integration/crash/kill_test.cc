// kill -9 at random moments: what was answered is kept, once.
#include <cstdlib>
#include <iostream>
#include <thread>

#include "mapstore/store/sqlite_store.h"
#include "tests/integration/crash/robot_day.h"
#include "tests/integration/crash/small_street.h"
#include "tests/support/run_binary.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"

namespace maploc::testing {
namespace {

using Moment = std::chrono::steady_clock::time_point;

constexpr int kRobots = 16;
constexpr std::chrono::milliseconds kLongestLife{2500};
constexpr std::chrono::milliseconds kLongestStart{150};
constexpr std::chrono::seconds kMayBeLost{1};

int Kills() {
  const char* kills = std::getenv("MAPLOC_KILLS");
  return kills != nullptr ? std::atoi(kills) : 8;
}

Moment RandomMomentWithin(std::chrono::milliseconds span, Random& random) {
  return std::chrono::steady_clock::now() +
         std::chrono::microseconds(static_cast<int>(random.Uniform() * 1000.0 * span.count()));
}

class KillTest : public ::testing::Test {
 protected:
  KillTest() : world_(TestRandom(), SmallStreet()), queries_(DrawQueries(world_, TestRandom(1))) {
    map_ = ImportWorld(world_, OpenStore().get());
    for (int i = 0; i < kRobots; ++i) {
      robots_.emplace_back("rover-" + std::to_string(i), queries_, TestRandom(100 + i));
    }
  }

  // Never open while a server runs: what is read of it was read from the disk anew.
  std::unique_ptr<MapStore> OpenStore() const {
    return OpenSqliteStore(folder_.File("store")).value();
  }

  // All robots at work, and the server killed within kLongestLife.
  void WorkAndKill(Random& random) {
    const std::string address = server_.Start();
    std::vector<std::thread> threads;
    for (RobotDay& robot : robots_) {
      threads.emplace_back([&robot, &address] { robot.WorkUntilTheServerDies(address); });
    }
    std::this_thread::sleep_until(RandomMomentWithin(kLongestLife, random));
    killed_ = std::chrono::steady_clock::now();
    server_.Kill();
    for (std::thread& thread : threads) thread.join();
  }

  // A server that dies while it starts.
  void StartAndKill(Random& random) {
    server_.Launch();
    std::this_thread::sleep_until(RandomMomentWithin(kLongestStart, random));
    server_.Kill();
  }

  void CheckTheStoreVerifies() const {
    const Output verify = RunBinary("maploc-map verify --store " + folder_.File("store"));
    EXPECT_EQ(verify.exit_code, 0) << verify.out << verify.error;
  }

  // What a robot was told of the session that the kill interrupted, and what the store has of it.
  void Settle(const MapStore& store, RunningSession& session) {
    const auto kept = static_cast<std::int64_t>(store.ListObservations(session.id)->size());
    const auto old = std::ranges::count_if(
        session.answered, [this](Moment moment) { return moment <= killed_ - kMayBeLost; });
    ASSERT_GE(kept, session.settled + old) << "session " << session.id;
    EXPECT_LE(kept, session.Known() + session.unanswered) << "session " << session.id;
    for (std::int64_t i = kept; i < session.Known(); ++i) {
      ++lost_;
      const auto age = killed_ - session.answered.at(i - session.settled);
      oldest_lost_ = std::max(oldest_lost_, age);
    }
    const bool ended = store.GetSession(session.id)->end != SessionEnd::kOpen;
    EXPECT_TRUE(!ended || session.end_was_asked) << "session " << session.id;
    if (ended) {
      EXPECT_EQ(kept, session.Known()) << "session " << session.id;
    }
    session.settled = kept;
    session.answered.clear();
    session.unanswered = 0;
  }

  void SettleAll(const MapStore& store) {
    for (RobotDay& robot : robots_) {
      if (robot.running()) Settle(store, *robot.running());
    }
  }

  // Every EndSession that was answered is in the store; `known` grows by those that are new.
  void CheckNewEnds(const MapStore& store, std::map<SessionId, SessionSummary>& known) const {
    for (const RobotDay& robot : robots_) {
      for (const auto& [id, summary] : robot.ended()) {
        if (!known.emplace(id, summary).second) continue;
        const Session session = store.GetSession(id).value();
        EXPECT_EQ(session.end, SessionEnd::kByRobot) << id;
        EXPECT_EQ(static_cast<std::int64_t>(store.ListObservations(id)->size()), summary.queries);
      }
    }
  }

  const TemporaryFolder folder_;
  const DrawnWorld world_;
  const std::vector<Query> queries_;
  MapKey map_;
  ServerProcess server_{folder_, {"--queue", "64", "--log-level", "warn"}};
  std::vector<RobotDay> robots_;
  Moment killed_;
  std::int64_t lost_ = 0;
  Moment::duration oldest_lost_{0};
};

// Each session's rows say what its EndSession answered, and the aggregates hold each row once.
void ExpectCountedOnce(const MapStore& store, const MapKey& map,
                       const std::map<SessionId, SessionSummary>& ended) {
  std::map<SessionId, std::map<SegmentId, std::int64_t>> counted;
  const std::vector<SegmentSummary> segments = store.ListSegments(map).value();
  for (const SegmentSummary& segment : segments) {
    std::int64_t queries = 0;
    const std::vector<SegmentSessionRow> rows = store.ListRows(map, segment.id).value();
    for (const SegmentSessionRow& row : rows) {
      EXPECT_TRUE(counted[row.session].emplace(segment.id, row.queries).second) << row.session;
      queries += row.queries;
    }
    EXPECT_EQ(segment.statistics.sessions, static_cast<std::int64_t>(rows.size()));
    EXPECT_EQ(segment.statistics.queries, queries);
  }
  for (const auto& [id, summary] : ended) {
    std::map<SegmentId, std::int64_t> told;
    for (const auto& change : summary.segments) told[change.segment] = change.queries;
    EXPECT_EQ(counted[id], told) << id;
  }
  EXPECT_EQ(counted.size(), ended.size());
}

TEST_F(KillTest, WhatWasAnsweredIsKeptOnce) {
  const int kills = Kills();
  Random random = TestRandom(2);
  std::cout << "seed " << TestSeed(2) << '\n';
  std::map<SessionId, SessionSummary> ended;
  for (int kill = 1; kill <= kills && !HasFailure(); ++kill) {
    SCOPED_TRACE("kill " + std::to_string(kill));
    WorkAndKill(random);
    if (kill % 4 == 0) StartAndKill(random);
    CheckTheStoreVerifies();
    const std::unique_ptr<MapStore> store = OpenStore();
    SettleAll(*store);
    CheckNewEnds(*store, ended);
  }

  // A last server: every EndSession once more, those that were answered and those that were not.
  const Client client(server_.Start());
  for (const auto& [id, summary] : ended) EXPECT_EQ(client.EndSession(id).value(), summary);
  for (RobotDay& robot : robots_) {
    if (!robot.running()) continue;
    const RunningSession& session = *robot.running();
    const SessionSummary summary = client.EndSession(session.id).value();
    EXPECT_EQ(summary.queries, session.settled);
    EXPECT_EQ(client.EndSession(session.id).value(), summary);
    ended.emplace(session.id, summary);
  }
  server_.Kill();
  CheckTheStoreVerifies();
  ExpectCountedOnce(*OpenStore(), map_, ended);

  std::int64_t queries = 0;
  for (const auto& [id, summary] : ended) queries += summary.queries;
  EXPECT_GT(queries, kills);
  std::cout << kills << " kills, " << ended.size() << " sessions, " << queries
            << " observations counted; lost of open sessions: " << lost_ << ", the oldest "
            << std::chrono::duration<double, std::milli>(oldest_lost_).count()
            << " ms before its kill\n";
}

}  // namespace
}  // namespace maploc::testing
