// From a robot's query over the server's recording to what the tools tell of it.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "client/api/client.h"
#include "mapstore/store/sqlite_store.h"
#include "proto/recording/recording.h"
#include "tests/support/files.h"
#include "tests/support/run_binary.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"

namespace maploc::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class RecorderTest : public ::testing::Test {
 protected:
  RecorderTest() : store_(OpenSqliteStore(folder_.File("store")).value()) {
    ImportWorld(world_, store_.get());
  }

  std::string Recording() const { return folder_.File("recording"); }
  static void Ask(const Client& client, const Query& query, Outcome outcome) {
    const Result<Localization> answer = client.Localize(query);
    ASSERT_TRUE(answer.ok()) << answer.status().ToString();
    EXPECT_EQ(answer->outcome, outcome);
  }
  Query QueryAt(double x) const {
    Random random = TestRandom(static_cast<int>(x));
    return world_.See(DrawnWorld::CameraFromMapAt(x, 0.2), QueryNoise(), random);
  }
  static Query Blind(Query query) {
    query.views[0].points = {};
    query.views[0].lines = {};
    return query;
  }
  // A drive along the street that ends where nothing is seen: seven queries, one of them refused.
  void Drive(const std::string& address) const {
    const Client client(address);
    const SessionId session = client.StartSession("street", "rover", {}).value();
    for (const double x : {2.0, 6.0, 10.0, 20.0, 22.0, 24.0}) {
      Query query = QueryAt(x);
      query.session = session;
      Ask(client, query, Outcome::kLocalized);
    }
    Query blind = Blind(QueryAt(2.0));
    blind.session = session;
    Ask(client, blind, Outcome::kTooFewMatches);
    EXPECT_TRUE(client.EndSession(session).ok());
  }
  // REQUIRES: the server is stopped, so that all that it has recorded is there.
  std::size_t Recorded(const RecordingFilter& filter = {}) const {
    const auto positions = maploc::Recording::Open(Recording()).value().FindLast(filter, 1000);
    return positions.ok() ? positions->size() : 0;
  }
  static json Json(const std::string& command) {
    const Output run = RunBinary(command + " --json");
    EXPECT_EQ(run.exit_code, 0) << run.error;
    return json::parse(run.out, nullptr, false);
  }
  std::string Compare() const {
    return "maploc-map compare --store " + folder_.File("store") + " --map street --recorded " +
           Recording() + " ";
  }

  const TemporaryFolder folder_;
  const DrawnWorld world_{TestRandom()};
  const std::unique_ptr<MapStore> store_;
  ServerProcess server_{folder_, {"--recorder", Recording(), "--recorder-every", "1"}};
};

TEST_F(RecorderTest, TheSameServerGivesTheRecordedAnswersAgain) {
  Drive(server_.Start());
  server_.Stop();
  EXPECT_EQ(Recorded(), 7u);
  EXPECT_EQ(Recorded({.robot = "rover", .outcome = "TOO_FEW_MATCHES"}), 1u);
  const std::string replay =
      "maploc replay --server " + server_.Start() + " --recorded " + Recording();
  const json report = Json(replay + " --map street");
  EXPECT_EQ(report["queries"], 7);
  EXPECT_EQ(report["same"], 7) << report;
  EXPECT_EQ(report["localized_before"], 6);
  EXPECT_EQ(report["localized_after"], 6);
  EXPECT_EQ(Json(replay + " --outcome TOO_FEW_MATCHES --robot rover")["queries"], 1);
  EXPECT_EQ(Json(replay + " --last 2")["queries"], 2);
  EXPECT_EQ(store_->ListSessions().value().size(), 1u) << "the replay is no session";
  ExpectFailed(RunBinary(replay + " --robot another"), "NOTHING_RECORDED");
  EXPECT_EQ(RunBinary(replay + " --strategy 2p").exit_code, 2);
}

TEST_F(RecorderTest, ARepeatedQueryIsRecordedOnce) {
  const Client client(server_.Start());
  Query query = QueryAt(2.0);
  query.session = client.StartSession("street", "rover", {}).value();
  query.request_id = "photo 1";
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(client.Localize(query).ok());
  server_.Stop();
  EXPECT_EQ(Recorded(), 1u);
}

TEST_F(RecorderTest, AKilledServerLeavesWhatItHasRecorded) {
  Drive(server_.Start());
  ASSERT_TRUE(WaitFor([this] {
    const auto recording = maploc::Recording::Open(Recording());
    if (!recording.ok()) return false;
    const auto positions = recording->FindLast({}, 1000);
    return positions.ok() && positions->size() == 7;
  }));
  server_.Kill();
  Drive(server_.Start());
  server_.Stop();
  EXPECT_EQ(Recorded(), 14u);
}

TEST_F(RecorderTest, NoTokenIsInIt) {
  const Output made = RunBinary("maploc-server token create --store " + folder_.File("store") +
                                " --role robot --robot rover --map street");
  ASSERT_EQ(made.exit_code, 0) << made.error;
  ClientOptions options;
  options.credentials.token = made.out.substr(0, made.out.find('\n'));
  Ask(Client(server_.Start(), options), Blind(QueryAt(2.0)), Outcome::kTooFewMatches);
  server_.Stop();
  EXPECT_EQ(Recorded({.robot = "rover"}), 1u) << "the token's robot";
  const std::string bytes = ReadFile(Recording() + "/" + RecordingName(1));
  ASSERT_GT(options.credentials.token.size(), 20u);
  EXPECT_THAT(bytes, Not(HasSubstr(options.credentials.token)));
  struct stat state {};
  ASSERT_EQ(stat((Recording() + "/" + RecordingName(1)).c_str(), &state), 0);
  EXPECT_EQ(state.st_mode & 0777, 0600u);
}

// Robots and statistics do not depend on it.
TEST_F(RecorderTest, ARecordingThatIsTakenAwayStopsNobody) {
  const std::string address = server_.Start();
  std::filesystem::remove_all(Recording());
  Drive(address);
  server_.Stop();
  EXPECT_THAT(folder_.Read("stderr"), HasSubstr("queries are not recorded: "));
  EXPECT_EQ(store_->ListSessions().value().size(), 1u);
}

// A new version that lacks the street's second half.
TEST_F(RecorderTest, CompareFindsWhatAVersionLost) {
  Drive(server_.Start());
  server_.Stop();
  DrawnWorldOptions half;
  half.segments = 1;
  ImportWorld(DrawnWorld(TestRandom(), half), store_.get());
  const json report = Json(Compare() + "--version 1 --version 2");
  EXPECT_EQ(report["before"], "version 1");
  EXPECT_EQ(report["after"], "version 2");
  EXPECT_EQ(report["queries"], 7);
  EXPECT_GE(report["worse"], 3) << report;
  EXPECT_EQ(report["better"], 0) << report;
  EXPECT_EQ(report["localized_before"], 6);
  EXPECT_LE(report["localized_after"], 3);
  const json reversed = Json(Compare() + "--version 2 --version 1");
  EXPECT_EQ(reversed["better"], report["worse"]);
  const Output table = RunBinary(Compare() + "--version 1 --version 2 --last 3");
  EXPECT_THAT(table.out, HasSubstr("3 queries: "));
}

TEST_F(RecorderTest, CompareTriesStrategies) {
  Drive(server_.Start());
  server_.Stop();
  const json report = Json(Compare() + "--strategy mixed --strategy 2p");
  EXPECT_EQ(report["after"], "version 1 with 2p");
  EXPECT_EQ(report["localized_after"], 6) << report;
  EXPECT_EQ(RunBinary(Compare() + "--version 1").exit_code, 2);
  ExpectFailed(RunBinary(Compare() + "--version 1 --version 9"), "version 9");
  ExpectFailed(
      RunBinary("maploc-map compare --store " + folder_.File("store") +
                " --map street --strategy 2p --strategy mixed --recorded " + folder_.File("store")),
      folder_.File("store") + ": byte 0: is no recording");
}

}  // namespace
}  // namespace maploc::testing
