// What becomes of a session whose queries fail, come late or are interrupted.
#include "client/robot/replay.h"

#include <gmock/gmock.h>

#include "tests/integration/service/lossy_front.h"
#include "tests/integration/service/service_fixture.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;

// Eight views of the street.
class StreetRobot : public Robot {
 public:
  explicit StreetRobot(const DrawnWorld& world) : world_(world) {}

  int QueryCount() const override { return 8; }
  std::string QueryName(int index) const override { return "photo-" + std::to_string(index); }
  Result<Query> MakeQuery(int index) const override {
    Random random = TestRandom(index);
    return world_.See(DrawnWorld::CameraFromMapAt(X(index), 0.2), QueryNoise(), random);
  }
  Rigid3 ReferenceMapFromBody(int index) const override {
    return DrawnWorld::CameraFromMapAt(X(index), 0.2).Inverse();
  }
  std::optional<double> SceneDepth(int) const override { return std::nullopt; }

 private:
  static double X(int index) { return 2.0 + index; }
  const DrawnWorld& world_;
};

class ReplayTest : public ServiceTest {
 protected:
  ReplayTest() {
    ClientOptions options;
    options.call_timeout = std::chrono::milliseconds(2000);
    patient_ = std::make_unique<Client>(front_.Address(), options);
    options.call_timeout = std::chrono::milliseconds(400);
    hasty_ = std::make_unique<Client>(front_.Address(), options);
    EXPECT_FALSE(hasty_->ListMaps().ok());  // connects: the front has no maps
  }

  // `after(i)` is called once the i-th query (from 1) is answered.
  Result<ReplayReport> Run(const Client& client, const std::function<void(int)>& after = nullptr) {
    int answered = 0;
    return Replay(client, "street", StreetRobot(world_), options_replay_, [&](const ReplayEntry&) {
      ++answered;
      if (after) after(answered);
    });
  }
  Session OnlySession() const {
    const std::vector<Session> sessions = store_->ListSessions().value();
    EXPECT_EQ(sessions.size(), 1u);
    return sessions.front();
  }

  LossyFront front_{Address()};
  std::unique_ptr<Client> patient_;
  std::unique_ptr<Client> hasty_;
  ReplayOptions options_replay_;
};

TEST_F(ReplayTest, ALateAnswerIsAFailedQueryAndNotTheEnd) {
  front_.delay_ms = 800;
  const Result<ReplayReport> report = Run(*hasty_, [&](int answered) {
    if (answered == 3) front_.to_delay = 1;
  });
  ASSERT_TRUE(report.ok()) << report.status().ToString();
  ASSERT_EQ(report->entries.size(), 8u);
  EXPECT_EQ(report->CountLate(), 1);
  EXPECT_EQ(report->entries[3].OutcomeName(), "DEADLINE_EXCEEDED");
  EXPECT_FALSE(report->entries[3].error.has_value());
  EXPECT_EQ(report->entries[4].OutcomeName(), "LOCALIZED");
  EXPECT_EQ(Summarize(report->Errors()).queries, 8);
  EXPECT_EQ(OnlySession().end, SessionEnd::kByRobot);
}

TEST_F(ReplayTest, AServerThatNeverAnswersInTimeEndsTheSessionSoon) {
  front_.delay_ms = 800;
  const Result<ReplayReport> report = Run(*hasty_, [&](int answered) {
    if (answered == 1) front_.to_delay = kMaxLateInARow;
  });
  EXPECT_EQ(report.status().code(), StatusCode::kDeadlineExceeded);
  EXPECT_THAT(report.status().message(), HasSubstr("5th in a row without an answer"));
  EXPECT_THAT(report.status().message(), HasSubstr(OnlySession().id));
}

TEST_F(ReplayTest, ASessionThatFailsIsEndedAndDoesNotCount) {
  const Result<ReplayReport> report = Run(*patient_, [&](int answered) {
    if (answered == 3) front_.to_lose = ClientOptions().max_attempts;
  });
  const Session session = OnlySession();
  EXPECT_EQ(report.status().code(), StatusCode::kUnavailable);
  EXPECT_THAT(report.status().message(), HasSubstr("query 'photo-3'"));
  EXPECT_THAT(report.status().message(), HasSubstr("session " + session.id));
  EXPECT_THAT(report.status().message(), HasSubstr("after 3 of 8 answers and does not count"));
  EXPECT_EQ(session.end, SessionEnd::kByRobot);
  EXPECT_TRUE(session.revoked);
  EXPECT_EQ(CountedQueries(), 0);
}

TEST_F(ReplayTest, KeptPartlyItIsReported) {
  options_replay_.keep_partial = true;
  const Result<ReplayReport> report = Run(*patient_, [&](int answered) {
    if (answered == 3) front_.to_lose = ClientOptions().max_attempts;
  });
  ASSERT_TRUE(report.ok()) << report.status().ToString();
  EXPECT_EQ(report->entries.size(), 3u);
  EXPECT_EQ(report->session, OnlySession().id);
  EXPECT_EQ(report->failure.code(), StatusCode::kUnavailable);
  EXPECT_THAT(report->failure.message(), HasSubstr(report->session));
  EXPECT_FALSE(OnlySession().revoked);
  EXPECT_EQ(CountedQueries(), 4);  // the lost answer's too
}

TEST_F(ReplayTest, AStopEndsTheSession) {
  bool stop = false;
  options_replay_.stop = [&] { return stop; };
  const Result<ReplayReport> report = Run(*patient_, [&](int answered) { stop = answered == 2; });
  EXPECT_EQ(report.status().code(), StatusCode::kCancelled);
  EXPECT_THAT(report.status().message(), HasSubstr(OnlySession().id));
  EXPECT_EQ(OnlySession().end, SessionEnd::kByRobot);
}

TEST_F(ReplayTest, ASessionThatCannotBeEndedIsToldToo) {
  const Result<ReplayReport> report = Run(*patient_, [&](int answered) {
    if (answered == 8) front_.to_lose = 100;
  });
  EXPECT_EQ(report.status().code(), StatusCode::kUnavailable);
  EXPECT_THAT(report.status().message(),
              HasSubstr("`maploc end-session --server " + front_.Address() + " --session " +
                        OnlySession().id + "` ends it"));
}

}  // namespace
}  // namespace maploc::testing
