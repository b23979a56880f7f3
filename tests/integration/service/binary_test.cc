// The real binary as a process: what a signal in the middle of the work loses (nothing), and what
// it says when it cannot start.
#include <atomic>
#include <csignal>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/api/client.h"
#include "mapstore/store/sqlite_store.h"
#include "tests/contract/store/store_fixture.h"
#include "tests/support/process.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

class BinaryTest : public ::testing::Test {
 protected:
  std::vector<std::string> Command() const { return ServerCommand(folder_, folder_.File("store")); }
  std::string Read(const std::string& name) const { return folder_.Read(name); }

  const TemporaryFolder folder_;
};

// One robot that asks until the server is gone.
struct Robot {
  SessionId session;
  std::int64_t acknowledged = 0;
};

Robot RunUntilRefused(const std::string& address, const DrawnWorld& world, int index,
                      std::atomic<int>& answers) {
  const Client client(address);
  Robot robot;
  robot.session = client.StartSession("street", "rover-" + std::to_string(index), {}).value();
  Random random = TestRandom(index);
  while (true) {
    const Rigid3 camera_from_map =
        DrawnWorld::CameraFromMapAt(random.Uniform(1.0, 20.0), random.Uniform(-0.3, 0.3));
    Query query = world.See(camera_from_map, QueryNoise(), random);
    query.session = robot.session;
    if (!client.Localize(query).ok()) return robot;
    ++robot.acknowledged;
    ++answers;
  }
}

TEST_F(BinaryTest, ASignalInTheMiddleOfTheWorkLosesNothing) {
  const DrawnWorld world{TestRandom()};
  {
    const auto store = OpenSqliteStore(folder_.File("store")).value();
    ImportWorld(world, store.get());
  }
  Process server(Command(), folder_.File("stderr"));
  const std::string address = WaitForAddress(folder_);
  constexpr int kRobots = 3;
  std::atomic<int> answers = 0;
  std::vector<Robot> robots(kRobots);
  std::vector<std::thread> threads;
  for (int i = 0; i < kRobots; ++i) {
    threads.emplace_back([&, i] { robots[i] = RunUntilRefused(address, world, i, answers); });
  }
  ASSERT_TRUE(WaitFor([&] { return answers >= 30; })) << Read("stderr");

  server.Signal(SIGTERM);

  EXPECT_EQ(server.Wait(), 0) << Read("stderr");
  for (std::thread& thread : threads) thread.join();
  const auto store = OpenSqliteStore(folder_.File("store")).value();
  for (const Robot& robot : robots) {
    const auto kept = static_cast<std::int64_t>(store->ListObservations(robot.session)->size());
    // The query that the end caught may have been counted without its answer reaching the robot.
    EXPECT_GE(kept, robot.acknowledged);
    EXPECT_LE(kept, robot.acknowledged + 1);
  }
  EXPECT_TRUE(store->Verify().ok());
}

TEST_F(BinaryTest, AStoreThatIsNotSqliteIsOneLineAndExitOne) {
  folder_.Write("store", "not a store\n");
  Process server(Command(), folder_.File("stderr"));
  EXPECT_EQ(server.Wait(), 1);
  const std::string said = Read("stderr");
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_NE(said.find(folder_.File("store")), std::string::npos) << said;
  EXPECT_EQ(Read("store"), "not a store\n");
  EXPECT_FALSE(std::filesystem::exists(folder_.File("store-server")));
}

TEST_F(BinaryTest, ATruncatedStoreIsOneLineAndExitOne) {
  GiveMap(**OpenSqliteStore(folder_.File("store")));
  const std::string cut = Read("store").substr(0, 3 * 4096);
  folder_.Write("store", cut);
  Process server(Command(), folder_.File("stderr"));
  EXPECT_EQ(server.Wait(), 1);
  const std::string said = Read("stderr");
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_NE(said.find(folder_.File("store") + ": the store is truncated"), std::string::npos)
      << said;
  EXPECT_TRUE(Read("store") == cut);
}

TEST_F(BinaryTest, AnInterruptOrAClosedTerminalIsACleanEndToo) {
  for (const int signal : {SIGINT, SIGHUP}) {
    Process server(Command(), folder_.File("stderr"));
    WaitForAddress(folder_);
    server.Signal(signal);
    EXPECT_EQ(server.Wait(), 0) << Read("stderr");
    EXPECT_FALSE(std::filesystem::exists(folder_.File("port")));
  }
}

TEST_F(BinaryTest, TheSameCommandASecondTimeIsRefusedAndTouchesNothing) {
  Process server(Command(), folder_.File("stderr"));
  const std::string address = WaitForAddress(folder_);

  Process second(Command(), folder_.File("second"));

  EXPECT_EQ(second.Wait(), 1);
  EXPECT_NE(Read("second").find("STORE_IN_USE"), std::string::npos) << Read("second");
  EXPECT_EQ("127.0.0.1:" + Read("port"), address + "\n");
  EXPECT_TRUE(Client(address).ListMaps().ok());
}

TEST_F(BinaryTest, UnderNohupItOutlivesTheTerminal) {
  const auto before = std::signal(SIGHUP, SIG_IGN);  // inherited, as nohup does it
  Process server(Command(), folder_.File("stderr"));
  std::signal(SIGHUP, before);
  const std::string address = WaitForAddress(folder_);

  server.Signal(SIGHUP);
  EXPECT_TRUE(Client(address).ListMaps().ok());
  server.Signal(SIGTERM);

  EXPECT_EQ(server.Wait(), 0) << Read("stderr");
  // Of two that wait the lower number is taken first: a queued SIGHUP would be named here.
  const std::string said = Read("stderr");
  EXPECT_NE(said.find(strsignal(SIGTERM)), std::string::npos) << said;
  EXPECT_EQ(said.find(strsignal(SIGHUP)), std::string::npos) << said;
}

TEST_F(BinaryTest, ALogThatNobodyReadsAnyMoreDoesNotEndIt) {
  GiveMap(**OpenSqliteStore(folder_.File("store")));
  ASSERT_EQ(mkfifo(folder_.File("log").c_str(), 0600), 0);
  const int reader = open(folder_.File("log").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  Process server(Command(), folder_.File("log"));
  const std::string address = WaitForAddress(folder_);
  close(reader);
  // Each start of a session is a line of the log.
  const Client client(address);
  for (int i = 0; i < 3; ++i) {
    const Result<SessionId> session = client.StartSession("yard", "rover", {});
    EXPECT_TRUE(session.ok()) << session.status().ToString();
  }
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
}

}  // namespace
}  // namespace maploc::testing
