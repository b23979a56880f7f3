// Another process that holds the store: robots are told, and no probe takes the server for ill.
#include <gmock/gmock.h>

#include "client/api/client.h"
#include "mapstore/store/sqlite_database.h"
#include "mapstore/store/sqlite_store.h"
#include "tests/integration/crash/small_street.h"
#include "tests/support/byte_stream.h"
#include "tests/support/run_binary.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

// Takes the ten seconds that the server waits for the store.
TEST(BusyTest, AStoreThatIsHeldForAWhileIsNoBadHealth) {
  const TemporaryFolder folder;
  const DrawnWorld world(TestRandom(), SmallStreet());
  ImportWorld(world, OpenSqliteStore(folder.File("store")).value().get());
  ServerProcess server(folder, {"--log-level", "warn"});
  const std::string address = server.Start();
  ClientOptions once;
  once.max_attempts = 1;
  const Client client(address, once);
  Query query = DrawQueries(world, TestRandom(1)).front();
  query.session = client.StartSession("street", "rover", {}).value();

  auto other = SqliteDatabase::Open(folder.File("store"), SqliteAccess::kWrite, 1000);
  ASSERT_TRUE(other->Execute("BEGIN IMMEDIATE").ok());
  ASSERT_TRUE(client.Localize(query).ok());
  const auto log_says = [&](const std::string& what) {
    return folder.Read("stderr").find(what) != std::string::npos;
  };
  ASSERT_TRUE(WaitFor([&] { return log_says("(STORE_BUSY)"); }));
  EXPECT_EQ(HealthNow(address), kServing);
  EXPECT_FALSE(log_says("NOT_SERVING:"));
  EXPECT_TRUE(client.Localize(query).ok());

  ASSERT_TRUE(other->Execute("ROLLBACK").ok());
  EXPECT_EQ(client.EndSession(query.session)->queries, 2);
  EXPECT_EQ(HealthNow(address), kServing);
  server.Stop();
  const Output verify = RunBinary("maploc-map verify --store " + folder.File("store"));
  EXPECT_EQ(verify.exit_code, 0) << verify.error;
}

}  // namespace
}  // namespace maploc::testing
