// A log that nobody reads: a pipe to a supervisor that stands still, a terminal after Ctrl-S.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/api/client.h"
#include "maploc/v1/localization_service.grpc.pb.h"
#include "mapstore/store/sqlite_store.h"
#include "tests/integration/crash/small_street.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"

namespace maploc::testing {
namespace {

using std::chrono::steady_clock;

class UnreadLogTest : public ::testing::Test {
 protected:
  UnreadLogTest()
      : world_(TestRandom(), SmallStreet()), queries_(DrawQueries(world_, TestRandom(1))) {
    ImportWorld(world_, OpenSqliteStore(folder_.File("store")).value().get());
    const std::string pipe = folder_.File("stderr");
    EXPECT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    reader_ = open(pipe.c_str(), O_RDWR | O_NONBLOCK);
    address_ = server_.Start();
  }
  ~UnreadLogTest() override { close(reader_); }

  // What lies in the pipe.
  std::string Read() const {
    std::string log(1 << 16, '\0');
    const ssize_t size = read(reader_, log.data(), log.size());
    log.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return log;
  }
  // Some lines of the log.
  SessionSummary OneSession() const {
    const Client client(address_);
    const SessionId id = client.StartSession("street", "rover", {}).value();
    for (int i = 0; i < 2; ++i) {
      Query query = queries_[static_cast<std::size_t>(i)];
      query.session = id;
      EXPECT_TRUE(client.Localize(query).ok());
    }
    return client.EndSession(id).value();
  }
  // The robot is "Zürich" in Latin-1. Protobuf itself would write a line of it.
  void SendWhatIsNotUtf8() const {
    const auto stub = v1::LocalizationService::NewStub(
        grpc::CreateChannel(address_, grpc::InsecureChannelCredentials()));
    grpc::ClientContext context;
    v1::StartSessionRequest request;
    request.set_robot("Z\xfcrich");
    v1::StartSessionResponse response;
    EXPECT_FALSE(stub->StartSession(&context, request, &response).ok());
  }

  const TemporaryFolder folder_;
  const DrawnWorld world_;
  const std::vector<Query> queries_;
  ServerProcess server_{folder_};
  int reader_ = -1;
  std::string address_;
};

TEST_F(UnreadLogTest, HoldsUpNobodyAndCostsNoStatistics) {
  ASSERT_GT(fcntl(reader_, F_SETPIPE_SZ, 8192), 0);  // is full soon
  for (int i = 0; i < 60; ++i) ASSERT_EQ(OneSession().queries, 2);
  const std::string before = Read();
  EXPECT_THAT(before, ::testing::HasSubstr("serving"));
  OneSession();
  EXPECT_THAT(Read(), ::testing::HasSubstr("lines of the log are lost"));
  for (int i = 0; i < 60; ++i) ASSERT_EQ(OneSession().queries, 2);
  const auto asked = steady_clock::now();
  server_.Stop();
  EXPECT_LT(steady_clock::now() - asked, std::chrono::seconds(5));
}

// As after Ctrl-S, or on a serial line.
TEST_F(UnreadLogTest, ATerminalThatStandsStillHoldsUpNobodyEither) {
  server_.Stop();
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(grantpt(terminal), 0);
  ASSERT_EQ(unlockpt(terminal), 0);
  std::filesystem::remove(folder_.File("stderr"));
  std::filesystem::create_symlink(ptsname(terminal), folder_.File("stderr"));
  address_ = server_.Start();
  for (int i = 0; i < 120; ++i) ASSERT_EQ(OneSession().queries, 2);
  server_.Stop();
  close(terminal);
}

TEST_F(UnreadLogTest, HasNoLineThatIsNotTheServersOwn) {
  for (int i = 0; i < 3; ++i) SendWhatIsNotUtf8();
  server_.Stop();
  const std::string log = Read();
  EXPECT_THAT(log, ::testing::HasSubstr("NOT_PARSED"));
  EXPECT_THAT(log, ::testing::Not(::testing::HasSubstr("libprotobuf")));
}

}  // namespace
}  // namespace maploc::testing
