// A store that is killed, replaced, restored, deleted or full under a working server: what was
// acknowledged is in the store that was acknowledged, and from the fault on robots are told.
#include <atomic>
#include <chrono>
#include <list>
#include <thread>

#include <gmock/gmock.h>
#include <sys/resource.h>

#include "client/api/client.h"
#include "mapstore/store/sqlite_store.h"
#include "tests/integration/crash/small_street.h"
#include "tests/support/run_binary.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;
using Moment = std::chrono::steady_clock::time_point;

constexpr int kRobots = 4;

// Short sessions, one after the other, until a call is refused.
struct Robot {
  struct End {
    SessionSummary summary;
    Moment asked;
  };
  std::vector<End> acknowledged;
  Status refused;
  // What the test waits for while the robot works.
  std::atomic<int> sessions = 0;
  std::atomic<bool> ended = false;

  Status WorkOneSession(const Client& client, const std::vector<Query>& queries) {
    MAPLOC_ASSIGN_OR_RETURN(const SessionId id, client.StartSession("street", "rover", {}));
    for (std::size_t i = 0; i < 3; ++i) {
      Query query = queries[(acknowledged.size() + i) % queries.size()];
      query.session = id;
      MAPLOC_RETURN_IF_ERROR(client.Localize(query).status());
    }
    const Moment asked = std::chrono::steady_clock::now();
    MAPLOC_ASSIGN_OR_RETURN(const SessionSummary summary, client.EndSession(id));
    EXPECT_EQ(summary.queries, 3);
    acknowledged.push_back({summary, asked});
    ++sessions;
    return Status::Ok();
  }
  void Work(const std::string& address, const std::vector<Query>& queries,
            const std::atomic<bool>& stop) {
    ClientOptions once;
    once.max_attempts = 1;
    const Client client(address, once);
    while (!stop && refused.ok()) refused = WorkOneSession(client, queries);
    ended = true;
  }
};

class ReplaceTest : public ::testing::Test {
 protected:
  ReplaceTest()
      : world_(TestRandom(), SmallStreet()), queries_(DrawQueries(world_, TestRandom(1))) {
    ImportWorld(world_, OpenSqliteStore(store_).value().get());
    EXPECT_TRUE(BackupSqliteStore(store_, backup_).ok());
    address_ = server_.Start();
    for (Robot& robot : robots_) {
      threads_.emplace_back([&] { robot.Work(address_, queries_, stop_); });
    }
    WaitUntilEachHasEndedASession();
  }
  ~ReplaceTest() override { Join(); }

  void Join() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }
  // One more than at this moment.
  void WaitUntilEachHasEndedASession() {
    for (const Robot& robot : robots_) {
      const int before = robot.sessions;
      EXPECT_TRUE(WaitFor([&] { return robot.sessions > before; }));
    }
  }
  // A fault that ends every robot's work; its moment is when it has happened.
  void Fault(const std::function<void()>& fault) {
    fault();
    fault_ = std::chrono::steady_clock::now();
    for (const Robot& robot : robots_) EXPECT_TRUE(WaitFor([&] { return robot.ended.load(); }));
    Join();
  }
  void ExpectAllTold(const std::string& reason) const {
    for (const Robot& robot : robots_) {
      EXPECT_FALSE(robot.acknowledged.empty());
      EXPECT_EQ(robot.refused.reason(), reason) << robot.refused.ToString();
      for (const Robot::End& end : robot.acknowledged) EXPECT_LE(end.asked, fault_);
    }
  }
  // Every EndSession that was answered, whole.
  void ExpectAcknowledgedIn(const std::string& path) const {
    const auto store = OpenSqliteStore(path);
    ASSERT_TRUE(store.ok()) << store.status().ToString();
    for (const Robot& robot : robots_) {
      for (const Robot::End& end : robot.acknowledged) {
        const SessionId& id = end.summary.session;
        const Result<Session> session = (*store)->GetSession(id);
        ASSERT_TRUE(session.ok()) << session.status().ToString();
        EXPECT_EQ(session->end, SessionEnd::kByRobot);
        EXPECT_EQ((*store)->ListObservations(id)->size(), 3u);
      }
    }
  }
  static Output Verify(const std::string& path) {
    return RunBinary("maploc-map verify --store " + path);
  }
  static void ExpectVerifies(const std::string& path) {
    const Output verify = Verify(path);
    EXPECT_EQ(verify.exit_code, 0) << verify.error;
  }
  void ExpectServesAgain() {
    const Client client(server_.Start());
    EXPECT_TRUE(client.StartSession("street", "rover", {}).ok());
  }
  // Each of the server's threads tells it once, however often it meets it; the lines about refused
  // requests have the reason without brackets. Robots may be told first.
  void ExpectLoggedOnce(const std::string& what) const {
    constexpr int kThreads = 3;
    const auto is_logged = [&] { return folder_.Read("stderr").find(what) != std::string::npos; };
    EXPECT_TRUE(WaitFor(is_logged)) << folder_.Read("stderr");
    const std::string log = folder_.Read("stderr");
    int lines = 0;
    for (std::size_t at = log.find(what); at != log.npos; at = log.find(what, at + 1)) ++lines;
    EXPECT_LE(lines, kThreads) << log;
  }
  Output Restore() const {
    return RunBinary("maploc-map restore --store " + store_ + " --from " + backup_);
  }

  const TemporaryFolder folder_;
  const std::string store_ = folder_.File("store");
  const std::string backup_ = folder_.File("backup");
  const DrawnWorld world_;
  const std::vector<Query> queries_;
  ServerProcess server_{folder_, {"--queue", "64", "--log-level", "warn"}};
  std::string address_;
  std::list<Robot> robots_ = std::list<Robot>(kRobots);
  std::atomic<bool> stop_ = false;
  std::vector<std::thread> threads_;
  Moment fault_;
};

TEST_F(ReplaceTest, Killed) {
  Fault([&] { server_.Kill(); });
  ExpectVerifies(store_);
  ExpectAcknowledgedIn(store_);
}

TEST_F(ReplaceTest, AnotherFileMovedOverIt) {
  const std::string old = folder_.File("old");
  std::filesystem::create_hard_link(store_, old);  // so that the test can look into it
  Fault([&] { std::filesystem::rename(backup_, store_); });
  ExpectAllTold("STORE_REPLACED");
  ExpectLoggedOnce("(STORE_REPLACED)");
  // Robots are told first; the old file's log goes as soon as nobody reads there.
  EXPECT_TRUE(WaitFor([&] { return Verify(store_).exit_code == 0; }));
  server_.StopWithoutStore();
  ExpectVerifies(store_);
  ExpectVerifies(old);
  ExpectAcknowledgedIn(old);
  ExpectServesAgain();
}

// Without a clean stop, which would put the log away.
TEST_F(ReplaceTest, AnotherFileMovedOverItAndTheServerKilled) {
  Fault([&] {
    std::filesystem::rename(backup_, store_);
    server_.Kill();
  });
  const Output verify = Verify(store_);
  if (verify.exit_code != 0) {
    EXPECT_THAT(verify.error, HasSubstr("maploc-map restore"));
  }
  std::filesystem::copy_file(store_, backup_);
  EXPECT_EQ(Restore().exit_code, 0);
  ExpectVerifies(store_);
  ExpectServesAgain();
}

TEST_F(ReplaceTest, WrittenOver) {
  Fault([&] {
    std::filesystem::copy_file(backup_, store_, std::filesystem::copy_options::overwrite_existing);
  });
  for (const Robot& robot : robots_) {
    EXPECT_FALSE(robot.refused.ok());
    for (const Robot::End& end : robot.acknowledged) EXPECT_LE(end.asked, fault_);
  }
  server_.StopWithoutStore();
  EXPECT_EQ(folder_.Read("store"), folder_.Read("backup"));
  const Output restored = Restore();
  EXPECT_EQ(restored.exit_code, 0) << restored.error;
  ExpectVerifies(store_);
  ExpectServesAgain();
}

TEST_F(ReplaceTest, Deleted) {
  const std::string old = folder_.File("old");
  std::filesystem::create_hard_link(store_, old);
  Fault([&] { std::filesystem::remove(store_); });
  ExpectAllTold("STORE_REPLACED");
  server_.StopWithoutStore();
  ExpectVerifies(old);
  ExpectAcknowledgedIn(old);
  EXPECT_EQ(Restore().exit_code, 0);
  ExpectVerifies(store_);
  ExpectServesAgain();
}

TEST_F(ReplaceTest, RestoredInUseIsRefusedAndAfterwardsDone) {
  ExpectFailed(Restore(), "a maploc-server serves it");
  WaitUntilEachHasEndedASession();
  Join();
  for (const Robot& robot : robots_) EXPECT_TRUE(robot.refused.ok()) << robot.refused.ToString();
  server_.Stop();
  ExpectVerifies(store_);
  ExpectAcknowledgedIn(store_);
  EXPECT_EQ(Restore().exit_code, 0);
  ExpectVerifies(store_);
  EXPECT_TRUE(OpenSqliteStore(store_).value()->ListSessions()->empty());
  ExpectServesAgain();
}

// A limit on the size of files stands for a full disk: it needs no rights to set, and to lift.
TEST_F(ReplaceTest, FullAndThenNoLonger) {
  rlimit before{};
  Fault([&] {
    ASSERT_EQ(prlimit(server_.pid(), RLIMIT_FSIZE, nullptr, &before), 0);
    const rlimit none{0, before.rlim_max};
    ASSERT_EQ(prlimit(server_.pid(), RLIMIT_FSIZE, &none, nullptr), 0);
  });
  ExpectAllTold("DISK_FULL");
  EXPECT_THAT(robots_.front().refused.message(), HasSubstr("ulimit -f"));
  ASSERT_EQ(prlimit(server_.pid(), RLIMIT_FSIZE, &before, nullptr), 0);
  const Client client(address_);
  EXPECT_TRUE(WaitFor([&] { return client.StartSession("street", "rover", {}).ok(); }));
  server_.Stop();
  ExpectVerifies(store_);
  ExpectAcknowledgedIn(store_);
}

}  // namespace
}  // namespace maploc::testing
