// A disk on which folding the log into the store takes long, under a working server: what is half
// written is not another program's work, and no robot is refused.
#include <cstdlib>
#include <filesystem>
#include <list>
#include <thread>

#include <gmock/gmock.h>

#include "mapstore/store/sqlite_store.h"
#include "tests/integration/crash/small_street.h"
#include "tests/integration/crash/stubborn_robot.h"
#include "tests/support/run_binary.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

using ::testing::IsEmpty;

TEST(SlowDiskTest, ALongCheckpointIsNotAnotherProgram) {
  const TemporaryFolder folder;
  const std::string store = std::filesystem::canonical(folder.path()).string() + "/store";
  const DrawnWorld world{TestRandom(), SmallStreet()};
  const std::vector<Query> queries = DrawQueries(world, TestRandom(1));
  ImportWorld(world, OpenSqliteStore(store).value().get());

  setenv("LD_PRELOAD", MAPLOC_BIN_DIR "/libfaulty_disk.so", 1);
  setenv("MAPLOC_SLOW_FILE", store.c_str(), 1);
  ServerProcess server{folder, {"--queue", "64", "--log-level", "warn"}};
  const std::string address = server.Start(store);
  unsetenv("LD_PRELOAD");
  unsetenv("MAPLOC_SLOW_FILE");

  std::atomic<bool> stop = false;
  std::list<StubbornRobot> robots;
  std::vector<std::thread> threads;
  for (int i = 0; i < 6; ++i) {
    StubbornRobot& robot = robots.emplace_back(queries);
    threads.emplace_back([&] { robot.Work(address, stop); });
  }
  for (int checkpoint = 0; checkpoint < 2; ++checkpoint) {
    const auto before = std::filesystem::file_size(store);
    EXPECT_TRUE(WaitFor([&] { return std::filesystem::file_size(store) > before; }));
  }
  stop = true;
  for (std::thread& thread : threads) thread.join();
  for (const StubbornRobot& robot : robots) {
    EXPECT_GT(robot.acknowledged_so_far(), 0);
    for (const char* call : {"StartSession", "Localize", "EndSession"}) {
      EXPECT_THAT(robot.Refusals(call), IsEmpty()) << call;
    }
  }
  server.Stop();
  const Output verify = RunBinary("maploc-map verify --store " + store);
  EXPECT_EQ(verify.exit_code, 0) << verify.error;
}

}  // namespace
}  // namespace maploc::testing
