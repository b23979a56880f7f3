#include "server/sessions/answered_queries.h"

#include <optional>

#include <gtest/gtest.h>

namespace maploc {
namespace {

constexpr std::uint64_t kPayload = 7;

Localization Numbered(int iterations, std::size_t matches = 0) {
  Localization answer;
  answer.evidence.iterations = iterations;
  answer.matches.points.resize(matches);
  return answer;
}

class AnsweredQueriesTest : public ::testing::Test {
 protected:
  // The number of the answer that a repeat gets; nullopt: it would be worked on.
  std::optional<int> Repeated(const SessionId& session, const std::string& id) {
    const auto turn = queries_.Begin(session, id, kPayload);
    EXPECT_TRUE(turn.ok()) << turn.status().ToString();
    if (!turn.ok() || turn->repeated() == nullptr) return std::nullopt;
    return turn->repeated()->evidence.iterations;
  }
  void Answer(const SessionId& session, const std::string& id, Localization answer) {
    auto turn = queries_.Begin(session, id, kPayload);
    ASSERT_TRUE(turn.ok()) << turn.status().ToString();
    turn->Keep(std::move(answer));
  }

  AnsweredQueries queries_;
};

TEST_F(AnsweredQueriesTest, ARepeatGetsTheAnswerOfItsSessionAlone) {
  Answer("a", "q", Numbered(1));
  EXPECT_EQ(Repeated("a", "q"), 1);
  EXPECT_EQ(Repeated("a", "q"), 1);
  EXPECT_EQ(Repeated("a", "other"), std::nullopt);
  EXPECT_EQ(Repeated("b", "q"), std::nullopt);
}

TEST_F(AnsweredQueriesTest, WhileTheFirstRunsARepeatIsRefused) {
  std::optional<AnsweredQueries::Turn> first;
  first.emplace(queries_.Begin("a", "q", kPayload).value());
  const Status refused = queries_.Begin("a", "q", kPayload).status();
  EXPECT_EQ(refused.code(), StatusCode::kUnavailable);
  EXPECT_EQ(refused.reason(), "QUERY_RUNNING");
  EXPECT_EQ(Repeated("b", "q"), std::nullopt);
  first.reset();  // it failed
  EXPECT_EQ(Repeated("a", "q"), std::nullopt);
}

TEST_F(AnsweredQueriesTest, AnotherRequestUnderTheSameIdIsRefusedAtAnyTime) {
  auto first = queries_.Begin("a", "q", kPayload).value();
  for (int round = 0; round < 2; ++round) {
    const Status reused = queries_.Begin("a", "q", kPayload + 1).status();
    EXPECT_EQ(reused.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(reused.reason(), "REQUEST_ID_REUSED");
    if (round == 0) first.Keep(Numbered(1));
  }
  EXPECT_EQ(Repeated("a", "q"), 1);
}

TEST_F(AnsweredQueriesTest, OfASessionTheLastAnswersAreKept) {
  const int more = static_cast<int>(kAnswersOfSession) + 1;
  Answer("b", "0", Numbered(0));
  for (int i = 0; i < more; ++i) Answer("a", std::to_string(i), Numbered(i));
  EXPECT_EQ(Repeated("a", "0"), std::nullopt);
  EXPECT_EQ(Repeated("a", "1"), 1);
  EXPECT_EQ(Repeated("b", "0"), 0) << "another session's are left alone";
}

TEST_F(AnsweredQueriesTest, AllAnswersTogetherAreBounded) {
  constexpr std::size_t kMatches = 20000;
  for (int session = 0; session < 400; ++session) {
    Answer(std::to_string(session), "q", Numbered(session, kMatches));
    ASSERT_LE(queries_.bytes(), kAnswerBytes);
  }
  EXPECT_EQ(Repeated("0", "q"), std::nullopt);
  EXPECT_EQ(Repeated("399", "q"), 399);
  EXPECT_GT(queries_.bytes(), kAnswerBytes / 2);
}

}  // namespace
}  // namespace maploc
