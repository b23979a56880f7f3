// Another process that holds the store for long: reads and queries go on, who must wait gives up in
// time, and the server ends when it is told to.
#include <chrono>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "client/api/client.h"
#include "mapstore/store/sqlite_database.h"
#include "mapstore/store/sqlite_store.h"
#include "tests/integration/crash/small_street.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"

namespace maploc::testing {
namespace {

using std::chrono::steady_clock;

ClientOptions Once(std::chrono::milliseconds timeout) {
  ClientOptions options;
  options.call_timeout = timeout;
  options.max_attempts = 1;
  return options;
}

TEST(LockedStoreTest, NobodyWaitsForItLongerThanHeMust) {
  const TemporaryFolder folder;
  const DrawnWorld world(TestRandom(), SmallStreet());
  ImportWorld(world, OpenSqliteStore(folder.File("store")).value().get());
  ServerProcess server(folder);
  const std::string address = server.Start();
  Query query = DrawQueries(world, TestRandom(1)).front();
  query.session = Client(address).StartSession("street", "rover", {}).value();
  auto other = SqliteDatabase::Open(folder.File("store"), SqliteAccess::kWrite, 1000);
  ASSERT_TRUE(other->Execute("BEGIN IMMEDIATE").ok());

  // More than there are threads for sessions.
  std::vector<std::thread> starts;
  for (int i = 0; i < 12; ++i) {
    starts.emplace_back([&address, i] {
      const std::string robot = "robot " + std::to_string(i);
      const auto session =
          Client(address, Once(std::chrono::seconds(3))).StartSession("street", robot, {});
      EXPECT_FALSE(session.ok());
    });
  }
  const Client impatient(address, Once(std::chrono::seconds(1)));
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(impatient.GetMap("street").ok());
    EXPECT_TRUE(impatient.Localize(query).ok());
  }
  const auto end = steady_clock::now();
  EXPECT_FALSE(impatient.EndSession(query.session).ok());
  EXPECT_LT(steady_clock::now() - end, std::chrono::seconds(2));
  for (std::thread& start : starts) start.join();

  // With nobody before it, it hears why.
  const Status busy =
      Client(address, Once(std::chrono::seconds(2))).EndSession(query.session).status();
  EXPECT_EQ(busy.reason(), "STORE_BUSY");
  const auto stop = steady_clock::now();
  server.Stop(1);
  EXPECT_LT(steady_clock::now() - stop, std::chrono::seconds(10));
  EXPECT_NE(folder.Read("stderr").find("statistics are not on disk"), std::string::npos);
}

}  // namespace
}  // namespace maploc::testing
