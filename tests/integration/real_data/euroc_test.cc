// A drone in a room: binary descriptors, four sessions, gravity of a real IMU. The bounds are issue
// 2's; and what sessions leave behind in the store.
#include "tests/integration/real_data/real_data_fixture.h"

namespace maploc::testing {
namespace {

const std::vector<std::string> kSessions = {"session_1", "session_2", "session_3", "session_4"};

class EurocTest : public RealDataTest {
 protected:
  void SetUp() override {
    Require("euroc_v101");
    if (IsSkipped()) return;
    ASSERT_TRUE(Run("maploc-map",
                    {"import-colmap", "--store", Store(), "--map", "room", "--model", Data("map"),
                     "--database", Data("database.db"), "--gravity", "0,0,-1", "--scale", "1"})
                    .is_object());
    std::filesystem::copy_file(Store(), folder_.File("fresh"));
    Serve(Store());
  }

  json ReplaySession(const std::string& session) const {
    return Replay("room", session,
                  {"--database", Data("database.db"), "--gravity-csv", Data("gravity.csv"),
                   "--prior", "none", "--robot", "drone"});
  }
  // The per-query answers without their times.
  static std::vector<json> Answers(const json& report) {
    std::vector<json> answers = Queries(report);
    for (json& answer : answers) {
      answer.erase("server_ms");
      answer.erase("latency_ms");
    }
    return answers;
  }
};

TEST_F(EurocTest, NearlyEveryFrameIsLocalizedAndNoneWrongly) {
  std::vector<json> all;
  for (const std::string& session : kSessions) {
    const json report = ReplaySession(session);
    ASSERT_TRUE(report.is_object());
    EXPECT_EQ(report["wrong"], 0) << session;
    for (const json& query : Queries(report)) all.push_back(query);
  }
  ASSERT_EQ(all.size(), 71u);
  const auto good = [](const json& query) { return Within(query, 0.25, 5.0); };
  EXPECT_GE(std::count_if(all.begin(), all.end(), good), 68);
  EXPECT_LE(Median(Errors(all, "translation_error_m")), 0.03);
}

TEST_F(EurocTest, EachSessionChangesTheSegmentsItVisitedAndNoOthers) {
  auto before = SegmentCounts("room");
  for (const std::string& session : kSessions) {
    const json report = ReplaySession(session);
    ASSERT_TRUE(report.is_object());
    EXPECT_GT(report["localized"], 0) << session;
    auto expected = before;
    for (const json& query : Queries(report)) {
      const int segment = query["segment"];
      if (segment < 0) continue;
      ++expected[segment][0];
      if (query["outcome"] == "LOCALIZED") ++expected[segment][1];
    }
    const auto after = SegmentCounts("room");
    EXPECT_EQ(after, expected) << session;
    EXPECT_NE(after, before) << session;

    const json again =
        Run("maploc", {"end-session", "--server", Address(), "--session", report["session"]});
    EXPECT_EQ(again["queries"], report["queries"]);
    EXPECT_EQ(SegmentCounts("room"), after) << "a repeated end changed something";
    before = after;
  }
}

TEST_F(EurocTest, ARestartedServerGivesTheSameAnswers) {
  const json first = ReplaySession("session_1");
  ASSERT_TRUE(first.is_object());
  ASSERT_GT(first["localized"], 0);
  const auto counts = SegmentCounts("room");
  // The same state on another server: the same answers, to the last digit.
  ASSERT_NO_FATAL_FAILURE(Serve(folder_.File("fresh")));
  EXPECT_EQ(Answers(ReplaySession("session_1")), Answers(first));
  // The first store on yet another server: the session has ended there, with what it had counted.
  ASSERT_NO_FATAL_FAILURE(Serve(Store()));
  const json again =
      Run("maploc", {"end-session", "--server", Address(), "--session", first["session"]});
  EXPECT_EQ(again["queries"], first["queries"]);
  EXPECT_EQ(again["localized"], first["localized"]);
  EXPECT_EQ(SegmentCounts("room"), counts);
}

}  // namespace
}  // namespace maploc::testing
