// A robot's day: start, localize, end; and what a restart, a repetition and a crowd change.
#include <numbers>
#include <thread>

#include <gmock/gmock.h>

#include "tests/integration/service/service_fixture.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

class SessionServiceTest : public ServiceTest {};

TEST_F(SessionServiceTest, PosesComeBackRight) {
  const SessionId session = StartSession();
  for (const double x : {2.0, 8.0, 14.0, 20.0}) {
    const Result<Localization> answer = client_->Localize(QueryAt(x, session));
    ASSERT_TRUE(answer.ok()) << answer.status().ToString();
    ASSERT_EQ(answer->outcome, Outcome::kLocalized);
    EXPECT_LT((answer->map_from_body->translation - TruthAt(x)).norm(), 0.1);
    EXPECT_EQ(answer->map, map_);
    EXPECT_GT(answer->covariance(0, 0), 0.0);
    EXPECT_GT(answer->times.total_ms, 0.0);
  }
}

TEST_F(SessionServiceTest, AnswersWithoutGravityAndAgainstAWrongOne) {
  Query query = QueryAt(8.0);
  query.gravity.reset();
  const Result<Localization> without = client_->Localize(query);
  ASSERT_TRUE(without.ok()) << without.status().ToString();
  ASSERT_EQ(without->outcome, Outcome::kLocalized);
  EXPECT_EQ(without->evidence.strategy, Strategy::kP3P);
  EXPECT_FALSE(without->evidence.gravity_rejected);

  query.gravity = Gravity{Eigen::Vector3d(1, 0, 0), 0.01};  // the camera's right
  const Result<Localization> against = client_->Localize(query);
  ASSERT_TRUE(against.ok()) << against.status().ToString();
  ASSERT_EQ(against->outcome, Outcome::kLocalized);
  EXPECT_TRUE(against->evidence.gravity_rejected);
  EXPECT_NEAR(against->evidence.gravity_disagreement_rad, std::numbers::pi / 2, 0.1);
  EXPECT_LT((against->map_from_body->translation - TruthAt(8.0)).norm(), 0.1);
}

TEST_F(SessionServiceTest, MatchesComeWhenTheyAreAskedFor) {
  const Query query = QueryAt(8.0);
  const Result<Localization> without = client_->Localize(query);
  const Result<Localization> with = client_->Localize(query, /*include_matches=*/true);
  ASSERT_TRUE(with.ok() && without.ok());
  EXPECT_TRUE(without->matches.points.empty());
  EXPECT_EQ(static_cast<int>(with->matches.points.size()), with->evidence.points.matches);
}

TEST_F(SessionServiceTest, EachQueryCountsOnceInTheSegmentThatAnswered) {
  const SessionId session = StartSession();
  std::map<SegmentId, std::int64_t> expected;
  for (const double x : {2.0, 3.0, 4.0, 16.0}) {
    const Result<Localization> answer = client_->Localize(QueryAt(x, session));
    ASSERT_TRUE(answer.ok()) << answer.status().ToString();
    ++expected[answer->segment];
  }
  ASSERT_TRUE(client_->Localize(QueryAt(30.0)).ok());  // outside of any session: not counted
  EXPECT_EQ(CountedQueries(), 0);                      // not before the end

  const Result<SessionSummary> summary = client_->EndSession(session);

  ASSERT_TRUE(summary.ok()) << summary.status().ToString();
  EXPECT_EQ(summary->queries, 4);
  EXPECT_EQ(summary->localized, 4);
  std::map<SegmentId, std::int64_t> counted;
  const std::vector<RemoteSegment> segments = client_->ListSegments("street").value();
  for (const RemoteSegment& segment : segments) {
    if (segment.queries > 0) counted[segment.id] = segment.queries;
  }
  EXPECT_EQ(counted, expected);
}

TEST_F(SessionServiceTest, ADiscardedSessionDoesNotCountAndOneThatCountsIsNotDiscarded) {
  const SessionId wrong = StartSession();
  ASSERT_TRUE(client_->Localize(QueryAt(2.0, wrong)).ok());
  ASSERT_TRUE(client_->DiscardSession(wrong).ok());
  ASSERT_TRUE(client_->DiscardSession(wrong).ok());  // its answer may have been lost
  EXPECT_TRUE(store_->GetSession(wrong)->revoked);
  EXPECT_EQ(store_->GetSession(wrong)->end, SessionEnd::kByRobot);
  EXPECT_EQ(CountedQueries(), 0);
  const SessionId right = StartSession();
  ASSERT_TRUE(client_->Localize(QueryAt(2.0, right)).ok());
  ASSERT_TRUE(client_->EndSession(right).ok());
  EXPECT_EQ(client_->DiscardSession(right).status().reason(), "SESSION_CLOSED");
  EXPECT_EQ(CountedQueries(), 1);
  EXPECT_EQ(client_->DiscardSession("nobody").status().code(), StatusCode::kNotFound);
}

TEST_F(SessionServiceTest, ARepeatedEndAnswersTheSameAndChangesNothing) {
  const SessionId session = StartSession();
  const SegmentId segment = client_->Localize(QueryAt(2.0, session))->segment;
  const SessionSummary first = client_->EndSession(session).value();
  const auto rows = Rows(segment);
  const std::int64_t counter = store_->ChangeCounter().value();

  EXPECT_EQ(client_->EndSession(session).value(), first);
  RestartServer();
  EXPECT_EQ(client_->EndSession(session).value(), first);

  EXPECT_EQ(Rows(segment), rows);
  EXPECT_EQ(store_->ChangeCounter().value(), counter);
}

void ExpectSameAnswer(const Localization& a, const Localization& b) {
  ASSERT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.map_from_body->translation, b.map_from_body->translation);
  EXPECT_EQ(a.map_from_body->rotation.coeffs(), b.map_from_body->rotation.coeffs());
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.segment, b.segment);
  EXPECT_EQ(a.evidence.points, b.evidence.points);
  EXPECT_EQ(a.evidence.iterations, b.evidence.iterations);
  EXPECT_EQ(a.evidence.confidence, b.evidence.confidence);
}

TEST_F(SessionServiceTest, TheSameRequestGivesTheSameAnswerAlsoAfterARestart) {
  const Query query = QueryAt(14.0);
  const Localization first = client_->Localize(query).value();
  ExpectSameAnswer(client_->Localize(query).value(), first);
  RestartServer();
  ExpectSameAnswer(client_->Localize(query).value(), first);
}

TEST_F(SessionServiceTest, AnOpenSessionGoesOnAfterARestart) {
  const SessionId session = StartSession();
  ASSERT_TRUE(client_->Localize(QueryAt(2.0, session)).ok());
  RestartServer();
  ASSERT_TRUE(client_->Localize(QueryAt(3.0, session)).ok());
  EXPECT_EQ(client_->EndSession(session)->queries, 2);
}

// Each robot has two sessions at once, and all are in the same segments.
TEST_F(SessionServiceTest, ManyRobotsAtOnceAreAllCounted) {
  constexpr int kRobots = 16;
  constexpr int kQueries = 10;
  const auto run = [&](int robot) {
    const Client client(Address());
    std::vector<SessionId> sessions;
    for (int i = 0; i < 2; ++i) {
      const Result<SessionId> session =
          client.StartSession("street", "rover-" + std::to_string(robot), {{"season", "autumn"}});
      ASSERT_TRUE(session.ok()) << session.status().ToString();
      sessions.push_back(*session);
    }
    for (int i = 0; i < kQueries; ++i) {
      for (const SessionId& session : sessions) {
        const auto answer = client.Localize(QueryAt(2.0 + 2 * i, session, robot));
        ASSERT_TRUE(answer.ok()) << answer.status().ToString();
      }
    }
    for (const SessionId& session : sessions) {
      const Result<SessionSummary> summary = client.EndSession(session);
      ASSERT_TRUE(summary.ok()) << summary.status().ToString();
      EXPECT_EQ(summary->queries, kQueries);
    }
  };
  std::vector<std::thread> robots;
  for (int robot = 0; robot < kRobots; ++robot) robots.emplace_back(run, robot);
  for (std::thread& robot : robots) robot.join();
  EXPECT_EQ(CountedQueries(), kRobots * 2 * kQueries);
  EXPECT_TRUE(store_->Verify().ok());
}

TEST_F(SessionServiceTest, ASessionStaysOnItsMapVersion) {
  const SessionId session = StartSession();
  const MapKey newer = ImportWorld(world_, store_.get());
  ASSERT_GT(newer.version, map_.version);
  // Whoever comes now is served from the new version within a second.
  EXPECT_TRUE(WaitFor([&] { return client_->Localize(QueryAt(2.0))->map == newer; }));
  EXPECT_EQ(client_->Localize(QueryAt(2.0, session))->map, map_);
  EXPECT_EQ(client_->GetMap("street")->info.key, newer);
}

TEST_F(SessionServiceTest, ARobotMayInsistOnAVersion) {
  const auto expect_mismatch = [](const Status& status, std::int64_t served, std::int64_t wanted) {
    EXPECT_EQ(status.code(), StatusCode::kFailedPrecondition);
    EXPECT_EQ(status.reason(), "MAP_VERSION_MISMATCH");
    EXPECT_THAT(status.message(), ::testing::HasSubstr("version " + std::to_string(served) + ", "));
    EXPECT_THAT(status.message(), ::testing::HasSubstr("insists on " + std::to_string(wanted)));
  };
  const SessionId old_session = client_->StartSession("street", "rover", {}, 1).value();
  expect_mismatch(client_->StartSession("street", "rover", {}, 2).status(), 1, 2);
  EXPECT_EQ(store_->ListSessions()->size(), 1u) << "a refused start opens none";
  const MapKey newer = ImportWorld(world_, store_.get());
  Query query = QueryAt(2.0);
  query.map_version = newer.version;
  EXPECT_TRUE(WaitFor([&] { return client_->Localize(query).ok(); }));
  query.map_version = 1;
  expect_mismatch(client_->Localize(query).status(), 2, 1);
  query.session = old_session;
  EXPECT_TRUE(client_->Localize(query).ok());
  query.map_version = newer.version;
  expect_mismatch(client_->Localize(query).status(), 1, 2);
  EXPECT_EQ(client_->EndSession(old_session)->queries, 1) << "a refused query counts nothing";
}

// Its segments are gone from the store before the server has seen the new version.
TEST_F(SessionServiceTest, AfterADeleteTheNewVersionAnswers) {
  ASSERT_TRUE(client_->Localize(QueryAt(3.0)).ok());
  const MapKey newer = ImportWorld(world_, store_.get());
  ASSERT_TRUE(store_->DeleteVersion(map_).ok());
  const auto answer = client_->Localize(QueryAt(20.0));
  ASSERT_TRUE(answer.ok()) << answer.status().ToString();
  EXPECT_EQ(answer->outcome, Outcome::kLocalized);
  EXPECT_EQ(answer->map, newer);
}

TEST_F(SessionServiceTest, APinOfAnotherProcessIsInForceSoon) {
  const Localization before = client_->Localize(QueryAt(2.0)).value();
  ASSERT_EQ(before.strategy_source, StrategySource::kDefault);
  ASSERT_TRUE(store_->PinStrategy(map_, before.segment, Strategy::k2P).ok());
  EXPECT_TRUE(WaitFor([&] {
    const Localization after = client_->Localize(QueryAt(2.0)).value();
    return after.strategy_source == StrategySource::kPinned &&
           after.evidence.strategy == Strategy::k2P;
  }));
}

TEST_F(SessionServiceTest, MapsAreDescribed) {
  const std::vector<RemoteMap> maps = client_->ListMaps().value();
  ASSERT_EQ(maps.size(), 1u);
  EXPECT_EQ(maps[0].info.key, map_);
  EXPECT_TRUE(maps[0].info.metric);
  EXPECT_EQ(maps[0].segments, 3);
  EXPECT_GT(maps[0].points, 0);
  EXPECT_EQ(maps[0].info.point_descriptor, DrawnWorld::PointKind());
  EXPECT_EQ(maps[0].info.line_descriptor, DrawnWorld::LineKind());
  const RemoteSegment segment = client_->GetSegment("street", 1).value();
  EXPECT_EQ(segment.points, world_.segments()[1]->points.size());
  EXPECT_EQ(segment.path_in_map, world_.segments()[1]->path_in_map);
  EXPECT_FALSE(segment.point_inlier_ratio.has_value());
  EXPECT_EQ(client_->ListSegments("street")->size(), 3u);
}

}  // namespace
}  // namespace maploc::testing
