// A disk that fills, or turns read-only, under a working server, and is put right: robots are told,
// go on being localized, and lose nothing; the server recovers by itself.
#include <list>
#include <memory>
#include <set>
#include <thread>

#include <gmock/gmock.h>

#include "mapstore/store/sqlite_store.h"
#include "tests/integration/crash/small_street.h"
#include "tests/integration/crash/stubborn_robot.h"
#include "tests/support/byte_stream.h"
#include "tests/support/failing_disk.h"
#include "tests/support/run_binary.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Key;
using ::testing::UnorderedElementsAre;

constexpr int kRobots = 4;

struct Fault {
  std::string name;
  std::string reason;  // that robots are told
  std::unique_ptr<FailingDisk> (*disk)(const std::string& folder);
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class DiskTest : public ::testing::TestWithParam<Fault> {
 protected:
  void SetUp() override {
    disk_ = GetParam().disk(folder_.File("disk"));
    if (!disk_->Missing().empty()) GTEST_SKIP() << disk_->Missing();
    store_ = disk_->folder() + "/store";
    ImportWorld(world_, OpenSqliteStore(store_).value().get());
    address_ = server_.Start(store_);
  }
  void TearDown() override { Join(); }

  void BeginWork() {
    for (int i = 0; i < kRobots; ++i) {
      StubbornRobot& robot = robots_.emplace_back(queries_);
      threads_.emplace_back([&] { robot.Work(address_, stop_); });
    }
    WaitUntilEachHasAcknowledged(2);
  }
  void Join() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }
  void WaitUntilEachHasAcknowledged(int more) {
    for (const StubbornRobot& robot : robots_) {
      const int before = robot.acknowledged_so_far();
      ASSERT_TRUE(WaitFor([&] { return robot.acknowledged_so_far() >= before + more; }));
    }
  }
  // Each robot, of an end or of the start that follows it.
  void FailAndWaitUntilAllAreTold() {
    disk_->Fail();
    for (const StubbornRobot& robot : robots_) {
      ASSERT_TRUE(WaitFor([&] {
        return !robot.Refusals("EndSession").empty() || !robot.Refusals("StartSession").empty();
      }));
    }
    ASSERT_TRUE(WaitFor([&] { return HealthNow(address_) == kNotServing; }));
  }
  void ExpectTold() const {
    for (const StubbornRobot& robot : robots_) {
      for (const char* call : {"StartSession", "EndSession"}) {
        const auto refusals = robot.Refusals(call);
        if (refusals.empty()) continue;
        EXPECT_THAT(refusals, UnorderedElementsAre(Key(GetParam().reason))) << call;
      }
      EXPECT_THAT(robot.Refusals("Localize"), IsEmpty());
    }
    EXPECT_THAT(folder_.Read("stderr"), HasSubstr("NOT_SERVING: "));
    EXPECT_THAT(folder_.Read("stderr"), HasSubstr("(" + GetParam().reason + ")"));
  }
  void ExpectVerifies() const {
    const Output verify = RunBinary("maploc-map verify --store " + store_);
    EXPECT_EQ(verify.exit_code, 0) << verify.error;
  }
  // Every EndSession that was answered says, and the store holds, what the robot was answered.
  void ExpectAllAcknowledgedAreKept() const {
    const auto store = OpenSqliteStore(store_);
    ASSERT_TRUE(store.ok()) << store.status().ToString();
    for (const StubbornRobot& robot : robots_) {
      EXPECT_FALSE(robot.acknowledged().empty());
      for (const StubbornRobot::Ended& ended : robot.acknowledged()) {
        const Result<Session> session = (*store)->GetSession(ended.session);
        ASSERT_TRUE(session.ok()) << session.status().ToString();
        EXPECT_EQ(session->end, SessionEnd::kByRobot);
        EXPECT_EQ(ended.acknowledged, ended.answered);
        const auto kept = (*store)->ListObservations(ended.session);
        EXPECT_EQ(static_cast<int>(kept->size()), ended.answered);
      }
    }
  }

  const TemporaryFolder folder_;
  std::unique_ptr<FailingDisk> disk_;
  std::string store_;
  const DrawnWorld world_{TestRandom(), SmallStreet()};
  const std::vector<Query> queries_ = DrawQueries(world_, TestRandom(1));
  ServerProcess server_{folder_, {"--queue", "64", "--log-level", "warn"}};
  std::string address_;
  std::list<StubbornRobot> robots_;
  std::atomic<bool> stop_ = false;
  std::vector<std::thread> threads_;
};

TEST_P(DiskTest, RobotsAreToldAndAllIsThereOnceItIsPutRight) {
  BeginWork();
  FailAndWaitUntilAllAreTold();
  EXPECT_TRUE(Client(address_).ListMaps().ok());  // what is read goes on
  disk_->PutRight();
  WaitUntilEachHasAcknowledged(2);
  EXPECT_TRUE(WaitFor([&] { return HealthNow(address_) == kServing; }));
  Join();
  ExpectTold();
  for (StubbornRobot& robot : robots_) {
    const Status status = robot.EndOpenSession(address_);
    EXPECT_TRUE(status.ok()) << status.ToString();
  }
  server_.Stop();
  ExpectVerifies();
  ExpectAllAcknowledgedAreKept();
}

TEST_P(DiskTest, AServerThatIsKilledMeanwhileLosesNothingThatWasAcknowledged) {
  BeginWork();
  FailAndWaitUntilAllAreTold();
  server_.Kill();
  Join();
  disk_->PutRight();
  ExpectVerifies();
  ExpectAllAcknowledgedAreKept();
  address_ = server_.Start(store_);
  EXPECT_TRUE(Client(address_).StartSession("street", "rover", {}).ok());
}

// Nothing waits here, so no flush can fail.
TEST_P(DiskTest, ARefusedStartAloneIsBadHealthUntilTheDiskIsPutRight) {
  const Client client(address_);
  disk_->Fail();
  std::set<std::string> reasons;
  EXPECT_TRUE(WaitFor([&] {
    reasons.insert(client.StartSession("street", "rover", {}).status().reason());
    return HealthNow(address_) == kNotServing;
  }));
  EXPECT_TRUE(reasons.contains(GetParam().reason));
  disk_->PutRight();
  EXPECT_TRUE(WaitFor([&] { return HealthNow(address_) == kServing; }));
  server_.Stop();
  ExpectVerifies();
}

TEST_P(DiskTest, AStopThatLosesStatisticsSaysSoOnce) {
  const Client client(address_);
  Query query = queries_.front();
  query.session = client.StartSession("street", "rover", {}).value();
  disk_->Fail();
  ASSERT_TRUE(WaitFor([&] {
    EXPECT_TRUE(client.Localize(query).ok());
    return HealthNow(address_) == kNotServing;
  }));
  server_.Stop(1);
  const std::string log = folder_.Read("stderr");
  const std::string last = log.substr(log.rfind('\n', log.size() - 2) + 1);
  EXPECT_THAT(last, ::testing::StartsWith("maploc-server: statistics are not on disk: "));
  EXPECT_THAT(last, HasSubstr("(" + GetParam().reason + ")"));
  EXPECT_EQ(log.find("statistics are not on disk"), log.rfind("statistics are not on disk")) << log;
}

template <int kError>
std::unique_ptr<FailingDisk> Pretended(const std::string& folder) {
  return std::make_unique<PretendedDisk>(folder, kError);
}
std::unique_ptr<FailingDisk> Small(const std::string& folder) {
  return std::make_unique<SmallDisk>(folder);
}

INSTANTIATE_TEST_SUITE_P(Faults, DiskTest,
                         ::testing::Values(Fault{"SmallDisk", "DISK_FULL", Small},
                                           Fault{"Full", "DISK_FULL", Pretended<ENOSPC>},
                                           Fault{"ReadOnly", "STORE_NOT_WRITABLE",
                                                 Pretended<EROFS>}),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace maploc::testing
