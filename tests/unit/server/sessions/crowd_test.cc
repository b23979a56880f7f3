// 64 robots at once over a store on disk: 100,000 observations, none lost, none doubled.
#include <atomic>
#include <map>
#include <thread>

#include <gtest/gtest.h>

#include "mapstore/store/sqlite_store.h"
#include "server/sessions/session_manager.h"
#include "tests/contract/store/store_fixture.h"
#include "tests/support/files.h"
#include "tests/support/seed.h"

namespace maploc::testing {
namespace {

using namespace std::chrono_literals;

constexpr int kRobots = 64;
constexpr int kSessionsARobot = 8;
constexpr int kQueriesASession = 196;  // 100,352 in all
constexpr int kSegments = 3;

// What the robots know: the observations of each session by segment, -1 for out of the map.
using Counts = std::map<SessionId, std::map<SegmentId, std::int64_t>>;

class CrowdTest : public ::testing::Test {
 protected:
  CrowdTest() : map_(GiveMap(*store_, "yard", kSegments)) {
    SessionManagerOptions options;
    options.flush_interval = 5ms;  // so that writing and ending meet often
    manager_ = SessionManager::Create(store_.get(), options).value();
  }

  SessionId Start(int robot) {
    return manager_->Start({map_, "rover-" + std::to_string(robot), {}, ""}).value().id;
  }
  void Ask(const SessionId& id, SegmentId segment, Counts& counts) {
    Result<SessionManager::Lease> lease = manager_->Enter(id);
    ASSERT_TRUE(lease.ok()) << lease.status().ToString();
    const Observation observation = segment < 0 ? OutOfMap(1) : Seen(1, segment);
    ASSERT_TRUE(lease->Record(observation).ok());
    ++counts[id][segment];
  }
  void End(const SessionId& id, const Counts& counts) {
    const Result<SessionSummary> summary = manager_->End(id);
    ASSERT_TRUE(summary.ok()) << summary.status().ToString();
    std::int64_t asked = 0;
    for (const auto& [segment, count] : counts.at(id)) asked += count;
    EXPECT_EQ(summary->queries, asked) << id;
    EXPECT_EQ(manager_->End(id).value(), *summary);
  }

  // Two sessions at a time, their queries taken in turns.
  Counts RunRobot(int robot, Random random) {
    Counts counts;
    for (int pair = 0; pair < kSessionsARobot / 2; ++pair) {
      const SessionId first = Start(robot);
      const SessionId second = Start(robot);
      for (int turn = 0; turn < kQueriesASession; ++turn) {
        for (const SessionId& id : {first, second}) {
          Ask(id, static_cast<SegmentId>(random.Below(kSegments + 1)) - 1, counts);
        }
      }
      End(second, counts);
      End(first, counts);
    }
    return counts;
  }

  const TemporaryFolder folder_;
  const std::unique_ptr<MapStore> store_ = OpenSqliteStore(folder_.File("store")).value();
  const MapKey map_;
  std::unique_ptr<SessionManager> manager_;
};

TEST_F(CrowdTest, AHundredThousandObservationsAreAllCountedOnce) {
  std::vector<Counts> robots(kRobots);
  std::vector<std::thread> threads;
  for (int i = 0; i < kRobots; ++i) {
    threads.emplace_back([&, i] { robots[i] = RunRobot(i, TestRandom(i)); });
  }
  for (std::thread& thread : threads) thread.join();
  ASSERT_TRUE(manager_->Shutdown().ok());

  Counts asked;
  for (Counts& counts : robots) asked.merge(counts);
  ASSERT_EQ(asked.size(), static_cast<std::size_t>(kRobots * kSessionsARobot));
  Counts kept;
  std::int64_t total = 0;
  for (const auto& [id, counts] : asked) {
    const std::vector<Observation> observations = store_->ListObservations(id).value();
    for (std::size_t i = 0; i < observations.size(); ++i) {
      EXPECT_EQ(observations[i].sequence, static_cast<std::int64_t>(i + 1)) << id;
      ++kept[id][observations[i].segment];
      ++total;
    }
  }
  EXPECT_EQ(kept, asked);
  EXPECT_EQ(total, kRobots * kSessionsARobot * kQueriesASession);

  Counts rows;
  const std::vector<SegmentSummary> segments = store_->ListSegments(map_).value();
  for (const SegmentSummary& segment : segments) {
    std::int64_t queries = 0;
    const std::vector<SegmentSessionRow> of_segment = store_->ListRows(map_, segment.id).value();
    for (const SegmentSessionRow& row : of_segment) {
      rows[row.session][segment.id] = row.queries;
      queries += row.queries;
    }
    EXPECT_EQ(segment.statistics.queries, queries);
  }
  for (auto& [id, counts] : asked) counts.erase(-1);
  EXPECT_EQ(rows, asked);
  EXPECT_TRUE(store_->Verify().ok());
}

}  // namespace
}  // namespace maploc::testing
