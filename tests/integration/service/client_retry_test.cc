// What the client repeats, and what it must not: lost answers and refusals between it and the
// server.
#include "tests/integration/service/lossy_front.h"
#include "tests/integration/service/service_fixture.h"

namespace maploc::testing {
namespace {

class ClientRetryTest : public ServiceTest {
 protected:
  // Connects, so that no call that is counted is lost on the way to the front, which has no maps.
  ClientRetryTest() { EXPECT_FALSE(lossy_.ListMaps().ok()); }

  LossyFront front_{Address()};
  const Client lossy_{front_.Address()};
};

TEST_F(ClientRetryTest, ALostEndIsAskedForAgainAndAnswersTheSame) {
  const SessionId session = StartSession();
  const SegmentId segment = client_->Localize(QueryAt(2.0, session))->segment;
  front_.to_lose = 2;
  const Result<SessionSummary> summary = lossy_.EndSession(session);
  ASSERT_TRUE(summary.ok()) << summary.status().ToString();
  EXPECT_EQ(front_.calls, 3);
  EXPECT_EQ(summary->queries, 1);
  EXPECT_EQ(client_->EndSession(session).value(), *summary);
  EXPECT_EQ(Rows(segment).size(), 1u);
  EXPECT_EQ(CountedQueries(), 1);
}

TEST_F(ClientRetryTest, ALostStartOpensOneSession) {
  front_.to_lose = 1;
  const Result<SessionId> session = lossy_.StartSession("street", "rover", {});
  ASSERT_TRUE(session.ok()) << session.status().ToString();
  EXPECT_EQ(front_.calls, 2);
  ASSERT_EQ(store_->ListSessions()->size(), 1u);
  EXPECT_EQ(store_->ListSessions()->front().id, *session);
}

TEST_F(ClientRetryTest, AQueryWhoseAnswerWasLostIsRepeatedAndCountsOnce) {
  const SessionId session = StartSession();
  front_.to_lose = 2;
  const Result<Localization> answer = lossy_.Localize(QueryAt(2.0, session));
  ASSERT_TRUE(answer.ok()) << answer.status().ToString();
  EXPECT_EQ(front_.calls, 3);
  ASSERT_TRUE(lossy_.Localize(QueryAt(2.0, session)).ok()) << "another call is another query";
  EXPECT_EQ(client_->EndSession(session)->queries, 2);
}

TEST_F(ClientRetryTest, TheTimeOfACallHoldsForItsRepetitionsToo) {
  ClientOptions options;
  options.call_timeout = std::chrono::milliseconds(1000);
  options.max_attempts = 100;
  const Client hasty(front_.Address(), options);
  front_.to_refuse = 100;
  front_.pushback_ms = 300;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(hasty.Localize(QueryAt(2.0)).status().reason(), "QUEUE_FULL");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
  EXPECT_LT(front_.calls, 6);
}

TEST_F(ClientRetryTest, OutsideOfSessionsAQueryIsRepeated) {
  front_.to_lose = 1;
  EXPECT_TRUE(lossy_.Localize(QueryAt(2.0)).ok());
  EXPECT_EQ(front_.calls, 2);
}

TEST_F(ClientRetryTest, WhatWasRefusedBeforeItBeganIsRepeatedAfterTheTimeAskedFor) {
  const SessionId session = StartSession();
  front_.to_refuse = 2;
  front_.pushback_ms = 150;
  const auto start = std::chrono::steady_clock::now();
  const Result<Localization> answer = lossy_.Localize(QueryAt(2.0, session));
  ASSERT_TRUE(answer.ok()) << answer.status().ToString();
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(2 * 150));
  EXPECT_EQ(front_.calls, 3);
  EXPECT_EQ(client_->EndSession(session)->queries, 1);
}

TEST_F(ClientRetryTest, ALongWaitIsTheCallers) {
  front_.to_refuse = 1;
  front_.pushback_ms = 10000;
  const Result<SessionId> session = lossy_.StartSession("street", "rover", {});
  EXPECT_EQ(session.status().code(), StatusCode::kResourceExhausted);
  EXPECT_EQ(session.status().reason(), "QUEUE_FULL");
  EXPECT_EQ(front_.calls, 1);
}

TEST_F(ClientRetryTest, ItGivesUp) {
  front_.to_refuse = 100;
  front_.pushback_ms = 1;
  EXPECT_EQ(lossy_.Localize(QueryAt(2.0)).status().reason(), "QUEUE_FULL");
  EXPECT_EQ(front_.calls, ClientOptions().max_attempts);
}

}  // namespace
}  // namespace maploc::testing
