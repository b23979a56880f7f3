#include "server/sessions/session_manager.h"

#include <atomic>
#include <future>
#include <limits>
#include <set>
#include <thread>

#include <gmock/gmock.h>

#include "server/sessions/session_id.h"
#include "tests/support/wait_for.h"
#include "tests/unit/server/sessions/session_manager_fixture.h"

namespace maploc {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

TEST(SessionIdTest, NeverRepeatsAndIsLong) {
  std::set<SessionId> ids;
  for (int i = 0; i < 1000; ++i) ids.insert(NewSessionId().value());
  EXPECT_EQ(ids.size(), 1000u);
  EXPECT_EQ(ids.begin()->size(), 32u);
}

TEST_F(SessionManagerTest, QueriesReachTheDiskInOrder) {
  const SessionId id = StartSession();
  for (const SegmentId segment : {0, 1, -1}) Query(id, segment);
  EXPECT_EQ(OnDisk(id), 0u);  // nobody waited for it
  ASSERT_TRUE(manager_->Flush().ok());
  Query(id, 2);
  ASSERT_TRUE(manager_->Flush().ok());

  const std::vector<Observation> observations = memory_->ListObservations(id).value();
  ASSERT_EQ(observations.size(), 4u);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(observations[i].sequence, i + 1);
  EXPECT_EQ(observations[3].segment, 2);
}

TEST_F(SessionManagerTest, TheThreadWritesByItself) {
  options_.flush_interval = 5ms;
  Restart();
  const SessionId id = StartSession();
  Query(id, 0);
  EXPECT_TRUE(testing::WaitFor([&] { return OnDisk(id) == 1; }));
}

TEST_F(SessionManagerTest, EndCountsWhatIsAndWhatIsNotOnDisk) {
  const SessionId id = StartSession();
  Query(id, 0);
  ASSERT_TRUE(manager_->Flush().ok());
  Query(id, 0);
  Query(id, 2);

  const Result<SessionSummary> summary = manager_->End(id);

  ASSERT_TRUE(summary.ok()) << summary.status().ToString();
  EXPECT_EQ(summary->end, SessionEnd::kByRobot);
  EXPECT_EQ(summary->queries, 3);
  ASSERT_EQ(summary->segments.size(), 2u);
  EXPECT_EQ(summary->segments[0].queries, 2);
  EXPECT_EQ(summary->segments[1].segment, 2);
}

TEST_F(SessionManagerTest, EndedAgainItAnswersTheSameAndChangesNothing) {
  const SessionId id = StartSession();
  Query(id, 1);
  const SessionSummary first = manager_->End(id).value();
  const auto rows = memory_->ListRows(map_, 1).value();

  EXPECT_EQ(manager_->End(id).value(), first);
  Restart();
  EXPECT_EQ(manager_->End(id).value(), first);
  EXPECT_EQ(memory_->ListRows(map_, 1).value(), rows);
}

TEST_F(SessionManagerTest, OneImpossibleObservationDoesNotHoldUpTheOthers) {
  const SessionId id = StartSession();
  Query(id, 0);
  Observation impossible = Localized(0);
  impossible.evidence.confidence = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(manager_->Enter(id)->Record(impossible).code(), StatusCode::kInternal);
  Query(id, 0);
  EXPECT_TRUE(manager_->Flush().ok());
  EXPECT_EQ(OnDisk(id), 2u);
  EXPECT_EQ(manager_->End(id)->queries, 2);
}

TEST_F(SessionManagerTest, EndWaitsForRunningQueries) {
  const SessionId id = StartSession();
  std::optional<SessionManager::Lease> lease = manager_->Enter(id).value();
  auto end = std::async(std::launch::async, [&] { return manager_->End(id); });
  // The door is shut while the end waits.
  ASSERT_TRUE(
      testing::WaitFor([&] { return manager_->Enter(id).status().reason() == "SESSION_CLOSED"; }));
  EXPECT_EQ(end.wait_for(0s), std::future_status::timeout);

  EXPECT_TRUE(lease->Record(Localized(0)).ok());
  lease.reset();

  const Result<SessionSummary> summary = end.get();
  ASSERT_TRUE(summary.ok()) << summary.status().ToString();
  EXPECT_EQ(summary->queries, 1);
}

// A slow query may hold up an end for a minute; a crash in that minute must not cost the rest.
TEST_F(SessionManagerTest, WhatWasAnsweredIsWrittenWhileAnEndWaits) {
  const SessionId id = StartSession();
  Query(id, 0);
  std::optional<SessionManager::Lease> lease = manager_->Enter(id).value();
  auto end = std::async(std::launch::async, [&] { return manager_->End(id); });
  ASSERT_TRUE(
      testing::WaitFor([&] { return manager_->Enter(id).status().reason() == "SESSION_CLOSED"; }));

  EXPECT_TRUE(manager_->Flush().ok());
  EXPECT_EQ(OnDisk(id), 1u);

  EXPECT_TRUE(lease->Record(Localized(1)).ok());
  lease.reset();
  EXPECT_EQ(end.get()->queries, 2);
}

TEST_F(SessionManagerTest, AnEndThatIsTooLateLeavesTheSessionOpen) {
  const SessionId id = StartSession();
  std::optional<SessionManager::Lease> lease = manager_->Enter(id).value();
  const Result<SessionSummary> late = manager_->End(id, std::chrono::steady_clock::now());
  ASSERT_FALSE(late.ok());
  EXPECT_EQ(late.status().code(), StatusCode::kDeadlineExceeded);
  lease.reset();
  Query(id, 0);
  EXPECT_EQ(manager_->End(id)->queries, 1);
}

TEST_F(SessionManagerTest, TwoEndsAtOnceAreOne) {
  const SessionId id = StartSession();
  Query(id, 0);
  auto other = std::async(std::launch::async, [&] { return manager_->End(id); });
  const Result<SessionSummary> mine = manager_->End(id);
  EXPECT_EQ(mine.value(), other.get().value());
  EXPECT_EQ(memory_->ListRows(map_, 0)->size(), 1u);
}

TEST_F(SessionManagerTest, RobotsTogetherAreAllCounted) {
  options_.flush_interval = 1ms;
  Restart();
  constexpr int kRobots = 4;
  constexpr int kQueries = 200;
  const SessionId shared = StartSession();
  std::vector<std::thread> robots;
  for (int robot = 0; robot < kRobots; ++robot) {
    robots.emplace_back([&] {
      for (int i = 0; i < kQueries; ++i) Query(shared, i % 3);
    });
  }
  for (std::thread& robot : robots) robot.join();
  EXPECT_EQ(manager_->End(shared)->queries, kRobots * kQueries);
  EXPECT_EQ(OnDisk(shared), static_cast<std::size_t>(kRobots * kQueries));
}

TEST_F(SessionManagerTest, UnknownAndClosedAreToldApart) {
  EXPECT_EQ(manager_->Enter("nobody").status().reason(), "SESSION_NOT_FOUND");
  EXPECT_EQ(manager_->End("nobody").status().reason(), "SESSION_NOT_FOUND");
  const SessionId id = StartSession();
  ASSERT_TRUE(manager_->End(id).ok());
  EXPECT_EQ(manager_->Enter(id).status().reason(), "SESSION_CLOSED");
}

TEST_F(SessionManagerTest, ARepeatedStartIsTheSameSession) {
  const SessionId id = StartSession("start-1");
  EXPECT_EQ(StartSession("start-1"), id);
  EXPECT_NE(StartSession("start-2"), id);
  EXPECT_NE(manager_->Start({map_, "another", {}, "start-1"})->id, id);
  EXPECT_NE(StartSession(), StartSession());
  Restart();
  EXPECT_EQ(StartSession("start-1"), id);
  ASSERT_TRUE(manager_->End(id).ok());
  // A late repetition opens no second one, and gives none that takes no queries.
  const Status late = manager_->Start({map_, "rover", {}, "start-1"}).status();
  EXPECT_EQ(late.reason(), "REQUEST_ID_REUSED");
  EXPECT_THAT(late.message(), HasSubstr(id));
  NewSession elsewhere;
  elsewhere.map = MapKey{"garden", 1};
  elsewhere.robot = "rover";
  elsewhere.request_id = "start-1";
  EXPECT_EQ(manager_->Start(elsewhere).status().reason(), "REQUEST_ID_REUSED");
  clock_.Advance(25h);
  EXPECT_NE(StartSession("start-1"), id);
}

// A board whose clock was never set is no fault of the robot.
TEST_F(SessionManagerTest, AServerClockBefore1970IsTheServersFault) {
  clock_.Advance(-24h * 365 * 60);
  const Status status = manager_->Start({map_, "rover", {}, ""}).status();
  EXPECT_EQ(status.code(), StatusCode::kInternal);
  EXPECT_THAT(status.message(), HasSubstr("clock"));
}

TEST_F(SessionManagerTest, LabelsOfTheServerAreItsOwn) {
  const Result<Session> session =
      manager_->Start({map_, "rover", {{"maploc.request_id", "x"}}, "start-1"});
  EXPECT_EQ(session.status().reason(), "RESERVED_LABEL");
}

TEST_F(SessionManagerTest, TooManyOpenSessionsAreRefused) {
  options_.max_open_sessions = 2;
  Restart();
  const SessionId id = StartSession();
  Query(id, 0);
  Query(StartSession(), 0);
  EXPECT_EQ(manager_->Start({map_, "rover", {}, ""}).status().code(),
            StatusCode::kResourceExhausted);
  ASSERT_TRUE(manager_->End(id).ok());
  EXPECT_TRUE(manager_->Start({map_, "rover", {}, ""}).ok());
}

TEST_F(SessionManagerTest, InAFullServerTheOldestUnusedSessionMakesRoom) {
  options_.max_open_sessions = 3;
  Restart();
  const SessionId used = StartSession();
  Query(used, 0);
  const SessionId oldest = StartSession();
  clock_.Advance(std::chrono::seconds(1));
  const SessionId newer = StartSession();
  StartSession();
  EXPECT_TRUE(manager_->Enter(used).ok());
  EXPECT_TRUE(manager_->Enter(newer).ok());
  EXPECT_EQ(manager_->Enter(oldest).status().reason(), "SESSION_CLOSED");
}

TEST_F(SessionManagerTest, ARobotWithTooManySessionsIsRefusedAndAnotherIsNot) {
  options_.max_open_sessions_of_robot = 2;
  Restart();
  StartSession();
  StartSession();
  EXPECT_EQ(manager_->Start({map_, "rover", {}, ""}).status().reason(), "TOO_MANY_SESSIONS");
  EXPECT_TRUE(manager_->Start({map_, "another", {}, ""}).ok());
}

TEST_F(SessionManagerTest, OpenSessionsGoOnAfterARestart) {
  const SessionId id = StartSession();
  Query(id, 0);
  ASSERT_TRUE(manager_->Shutdown().ok());
  EXPECT_EQ(manager_->Enter(id).status().reason(), "SHUTTING_DOWN");
  Restart();
  Query(id, 1);
  ASSERT_TRUE(manager_->Flush().ok());
  EXPECT_EQ(memory_->ListObservations(id)->back().sequence, 2);
  EXPECT_EQ(manager_->End(id)->queries, 2);
}

TEST_F(SessionManagerTest, ManySessionsShareOneTransaction) {
  std::vector<SessionId> sessions;
  for (int i = 0; i < 100; ++i) Query(sessions.emplace_back(StartSession()), 0);
  ASSERT_TRUE(manager_->Flush().ok());
  EXPECT_EQ(store_.groups, 1);
  for (const SessionId& id : sessions) EXPECT_EQ(OnDisk(id), 1u);
}

TEST_F(SessionManagerTest, IdleSessionsEnd) {
  options_.idle_timeout = 10min;
  Restart();
  const SessionId idle = StartSession();
  const SessionId busy = StartSession();
  const SessionId running = StartSession();
  Query(idle, 0);
  const std::optional<SessionManager::Lease> lease = manager_->Enter(running).value();
  clock_.Advance(6min);
  Query(busy, 0);
  clock_.Advance(6min);
  EXPECT_TRUE(manager_->CloseIdle().ok());

  EXPECT_EQ(memory_->GetSession(idle)->end, SessionEnd::kIdle);
  EXPECT_EQ(memory_->GetSession(busy)->end, SessionEnd::kOpen);
  EXPECT_EQ(memory_->GetSession(running)->end, SessionEnd::kOpen);
  const SessionSummary summary = manager_->End(idle).value();  // the robot comes back
  EXPECT_EQ(summary.end, SessionEnd::kIdle);
  EXPECT_EQ(summary.queries, 1);
}

TEST_F(SessionManagerTest, AnEndByAnotherProcessIsNoticed) {
  const SessionId id = StartSession();
  Query(id, 0);
  ASSERT_TRUE(memory_->EndSession(id, SessionEnd::kByRobot, 1, {}).ok());
  EXPECT_TRUE(manager_->Flush().ok());
  EXPECT_EQ(manager_->Enter(id).status().reason(), "SESSION_CLOSED");
}

}  // namespace
}  // namespace maploc
