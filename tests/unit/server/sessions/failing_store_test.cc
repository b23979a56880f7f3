// A store that fails under a session manager: nothing is lost, and whoever must know is told.
#include <future>

#include "tests/support/wait_for.h"
#include "tests/unit/server/sessions/session_manager_fixture.h"

namespace maploc {
namespace {

using namespace std::chrono_literals;

class FailingStoreTest : public SessionManagerTest {};

TEST_F(FailingStoreTest, WhatTheStoreRefusesIsWrittenLater) {
  const SessionId id = StartSession();
  Query(id, 0);
  store_.failing = true;
  EXPECT_EQ(manager_->Flush().reason(), "DISK_FULL");
  Query(id, 0);
  store_.failing = false;
  ASSERT_TRUE(manager_->Flush().ok());
  EXPECT_EQ(OnDisk(id), 2u);
}

TEST_F(FailingStoreTest, TheAgeOfWhatWaitsIsThatOfTheOldest) {
  EXPECT_EQ(manager_->unsaved_age_s(), 0.0);
  const SessionId first = StartSession();
  const SessionId second = StartSession();
  store_.failing = true;
  for (const SessionId& id : {second, first}) {
    Observation observation = Localized(0);
    observation.time_unix_ns = clock_.NowUnixNanos();
    ASSERT_TRUE(manager_->Enter(id)->Record(observation).ok());
    clock_.Advance(20s);
  }
  EXPECT_NEAR(manager_->unsaved_age_s(), 40.0, 1e-6);
  store_.failing = false;
  ASSERT_TRUE(manager_->Flush().ok());
  EXPECT_EQ(manager_->unsaved_age_s(), 0.0);
}

TEST_F(FailingStoreTest, ASessionThatTheStoreRefusesHoldsUpNobody) {
  const SessionId good = StartSession();
  const SessionId bad = StartSession();
  const SessionId ended = StartSession();
  for (const SessionId& id : {good, bad, ended}) Query(id, 0);
  ASSERT_TRUE(memory_->EndSession(ended, SessionEnd::kByRobot, 1, {}).ok());
  store_.poisoned = bad;
  EXPECT_FALSE(manager_->Flush().ok());
  EXPECT_EQ(OnDisk(good), 1u);
  EXPECT_EQ(manager_->Enter(ended).status().reason(), "SESSION_CLOSED");
  EXPECT_EQ(manager_->lost_observations(), 1u);
  store_.poisoned.clear();
  EXPECT_TRUE(manager_->Flush().ok());
  EXPECT_EQ(OnDisk(bad), 1u);
}

TEST_F(FailingStoreTest, QueriesAreRefusedRatherThanUncounted) {
  options_.max_unsaved_observations = 3;
  Restart();
  const SessionId id = StartSession();
  store_.failing = true;
  for (int i = 0; i < 3; ++i) Query(id, 0);
  EXPECT_EQ(manager_->Enter(id).status().reason(), "STATISTICS_BACKLOG");
  store_.failing = false;
  ASSERT_TRUE(manager_->Flush().ok());
  Query(id, 0);
  EXPECT_EQ(manager_->End(id)->queries, 4);
}

// Else health would be good on a full disk as soon as nothing waits.
TEST_F(FailingStoreTest, ARefusedStartIsBadHealthUntilTheStoreTakesSomething) {
  options_.flush_interval = 1ms;
  options_.health = &health_;
  store_.failing = store_.refuses_starts = true;
  Restart();
  EXPECT_EQ(store_.groups, 0);
  EXPECT_EQ(manager_->Start({map_, "rover", {}, ""}).status().reason(), "DISK_FULL");
  ASSERT_TRUE(testing::WaitFor([&] { return store_.groups > 10; }));
  EXPECT_FALSE(health_.good());
  store_.failing = store_.refuses_starts = false;
  EXPECT_TRUE(testing::WaitFor([&] { return health_.good(); }));
}

TEST_F(FailingStoreTest, AStopWithNothingToWriteIsCleanThoughTheStoreFails) {
  store_.failing = store_.refuses_starts = true;
  EXPECT_FALSE(manager_->Start({map_, "rover", {}, ""}).ok());
  EXPECT_TRUE(manager_->Shutdown().ok());
}

// One process that holds the store for a while is no fault; one that holds up half of what may
// wait is.
TEST_F(FailingStoreTest, ABusyStoreIsBadHealthAtHalfTheBacklog) {
  options_.flush_interval = 1ms;
  options_.max_unsaved_observations = 6;
  options_.health = &health_;
  store_.failing_as = "STORE_BUSY";
  Restart();
  const SessionId id = StartSession();
  store_.failing = true;
  Query(id, 0);
  const int before = store_.groups;
  ASSERT_TRUE(testing::WaitFor([&] { return store_.groups > before + 10; }));
  EXPECT_TRUE(health_.good());
  Query(id, 0);
  Query(id, 0);
  EXPECT_TRUE(testing::WaitFor([&] { return !health_.good(); }));
  EXPECT_TRUE(manager_->Enter(id).ok());  // nobody is refused yet
  store_.failing = false;
  EXPECT_TRUE(testing::WaitFor([&] { return health_.good(); }));
  EXPECT_EQ(OnDisk(id), 3u);
}

TEST_F(FailingStoreTest, AShutdownAmidAFailingIdleEndLosesNothing) {
  options_.flush_interval = 1ms;
  options_.idle_timeout = 10min;
  store_.failing = true;  // so that the query is still in memory when the session is ended
  store_.hold_ends = true;
  Restart();
  const SessionId id = StartSession();
  Query(id, 0);
  clock_.Advance(11min);
  ASSERT_TRUE(testing::WaitFor([&] { return store_.held.load(); }));
  store_.failing = false;
  auto shutdown = std::async(std::launch::async, [&] { return manager_->Shutdown(); });
  ASSERT_TRUE(
      testing::WaitFor([&] { return manager_->Enter(id).status().reason() == "SHUTTING_DOWN"; }));
  store_.hold_ends = false;
  store_.hold_ends.notify_all();
  EXPECT_TRUE(shutdown.get().ok());
  EXPECT_EQ(OnDisk(id), 1u);
}

}  // namespace
}  // namespace maploc
