// What the store keeps of a query is what the robot was told, answered or not.
#include "tests/integration/service/service_fixture.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

class ObservationTest : public ServiceTest {
 protected:
  Localization Ask(const Query& query) {
    const Result<Localization> answer = client_->Localize(query);
    EXPECT_TRUE(answer.ok()) << answer.status().ToString();
    return answer.ok() ? *answer : Localization();
  }
  Query See(const QueryNoise& noise, const SessionId& session) const {
    Random random = TestRandom(7);
    Query query = world_.See(DrawnWorld::CameraFromMapAt(8.0, 0.2), noise, random);
    query.session = session;
    return query;
  }
};

void ExpectTheSame(const Observation& kept, const Localization& told) {
  EXPECT_EQ(kept.outcome, told.outcome);
  EXPECT_EQ(kept.segment, told.segment);
  EXPECT_EQ(kept.evidence.points, told.evidence.points);
  EXPECT_EQ(kept.evidence.usable_lines, told.evidence.usable_lines);
  EXPECT_EQ(kept.evidence.vertical_lines, told.evidence.vertical_lines);
  EXPECT_EQ(kept.evidence.strategy, told.evidence.strategy);
  EXPECT_EQ(kept.evidence.fell_back, told.evidence.fell_back);
  EXPECT_EQ(kept.evidence.iterations, told.evidence.iterations);
  EXPECT_EQ(kept.evidence.gravity_disagreement_rad, told.evidence.gravity_disagreement_rad);
  EXPECT_EQ(kept.evidence.confidence, told.evidence.confidence);
  EXPECT_EQ(kept.total_ms, told.times.total_ms);
  EXPECT_GT(kept.time_unix_ns, 0);
}

TEST_F(ObservationTest, EveryQueryIsKeptAsItWasTold) {
  const SessionId session = StartSession();
  Query elsewhere = See({.outlier_share = 1.0}, session);
  elsewhere.prior = PosePrior{{0.0, 500.0, 0.0}, 1.0};
  const std::vector<Localization> told = {
      Ask(QueryAt(8.0, session)),
      Ask(See({.max_points = 1, .max_lines = 0}, session)),
      Ask(See({.outlier_share = 1.0}, session)),
      Ask(elsewhere),
  };
  ASSERT_TRUE(server_->Shutdown().ok());

  EXPECT_EQ(told[0].outcome, Outcome::kLocalized);
  EXPECT_GT(told[0].evidence.points.inliers, 0);
  EXPECT_GT(told[0].evidence.usable_lines.inliers, 0);
  EXPECT_GT(told[0].evidence.vertical_lines.inliers, 0);
  EXPECT_EQ(told[1].outcome, Outcome::kTooFewMatches);
  EXPECT_NE(told[2].outcome, Outcome::kLocalized);
  EXPECT_GT(told[2].evidence.points.matches, 0);
  EXPECT_EQ(told[3].outcome, Outcome::kOutOfMap);
  const std::vector<Observation> kept = store_->ListObservations(session).value();
  ASSERT_EQ(kept.size(), told.size());
  for (std::size_t i = 0; i < told.size(); ++i) {
    SCOPED_TRACE(i);
    ExpectTheSame(kept[i], told[i]);
  }
}

TEST_F(ObservationTest, AFallbackIsToldAndKept) {
  for (SegmentId segment = 0; segment < 3; ++segment) {
    ASSERT_TRUE(store_->PinStrategy(map_, segment, Strategy::k1P1L).ok());
  }
  ASSERT_TRUE(
      WaitFor([&] { return Ask(QueryAt(8.0)).strategy_source == StrategySource::kPinned; }));
  const SessionId session = StartSession();
  const Localization told = Ask(See({.max_lines = 0}, session));
  ASSERT_TRUE(client_->EndSession(session).ok());
  EXPECT_EQ(told.outcome, Outcome::kLocalized);
  EXPECT_TRUE(told.evidence.fell_back);
  EXPECT_NE(told.evidence.strategy, Strategy::k1P1L);
  EXPECT_EQ(told.strategy_source, StrategySource::kPinned);
  ExpectTheSame(store_->ListObservations(session)->front(), told);
}

TEST_F(ObservationTest, WhatAStrategyIsExpectedToDoIsTold) {
  EXPECT_EQ(Ask(QueryAt(8.0)).predicted_success, 0.0);  // before evidence
  for (int i = 0; i < 4; ++i) {
    const SessionId session = StartSession();
    for (int repetition = 0; repetition < 10; ++repetition) Ask(QueryAt(8.0, session, repetition));
    ASSERT_TRUE(client_->EndSession(session).ok());
  }
  const Localization answer = Ask(QueryAt(8.0));
  const SegmentSummary segment = store_->GetSegment(map_, answer.segment).value();
  EXPECT_EQ(answer.strategy_source, StrategySource::kLearned);
  EXPECT_GT(answer.predicted_success, 0.0);
  EXPECT_EQ(answer.predicted_success, segment.decision.predicted_success);

  // Another process takes the sessions out: the server answers as if they had never been.
  const std::vector<Session> sessions = store_->ListSessions().value();
  for (const Session& session : sessions) ASSERT_TRUE(store_->RevokeSession(session.id).ok());
  EXPECT_TRUE(WaitFor([&] {
    const Localization after = Ask(QueryAt(8.0));
    return after.strategy_source == StrategySource::kDefault && after.predicted_success == 0.0;
  }));
}

}  // namespace
}  // namespace maploc::testing
