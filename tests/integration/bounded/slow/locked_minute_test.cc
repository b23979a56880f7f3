// Another process holds the store for a minute: what a robot then waits for.
#include <algorithm>
#include <chrono>
#include <cstdio>
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

constexpr std::chrono::seconds kLocked{60};
constexpr std::chrono::seconds kDeadline{5};
constexpr double kMostMs = 100.0;
constexpr int kStarters = 12;  // more than there are threads for sessions

double Milliseconds(steady_clock::time_point since) {
  return std::chrono::duration<double, std::milli>(steady_clock::now() - since).count();
}

double Percentile99(std::vector<double> values) {
  std::ranges::sort(values);
  return values.at(values.size() * 99 / 100);
}

TEST(LockedMinuteTest, ReadsAndQueriesGoOnAndTheOthersHearInTime) {
  const TemporaryFolder folder;
  const DrawnWorld world(TestRandom(), SmallStreet());
  ImportWorld(world, OpenSqliteStore(folder.File("store")).value().get());
  ServerProcess server(folder);
  ClientOptions once;
  once.call_timeout = kDeadline;
  once.max_attempts = 1;
  const std::string address = server.Start();
  const Client robot(address, once);
  Query query = DrawQueries(world, TestRandom(1)).front();
  query.session = robot.StartSession("street", "rover", {}).value();
  auto other = SqliteDatabase::Open(folder.File("store"), SqliteAccess::kWrite, 1000);
  ASSERT_TRUE(other->Execute("BEGIN IMMEDIATE").ok());

  const auto end = steady_clock::now() + kLocked;
  std::vector<std::thread> waiting;
  for (int i = 0; i < kStarters; ++i) {
    waiting.emplace_back([&, i] {
      const Client starter(address, once);
      while (steady_clock::now() < end) {
        const auto begin = steady_clock::now();
        EXPECT_FALSE(starter.StartSession("street", "robot " + std::to_string(i), {}).ok());
        EXPECT_LT(Milliseconds(begin), 1000.0 * kDeadline.count() + kMostMs);
      }
    });
  }
  std::vector<double> reads_ms;
  std::vector<double> queries_ms;
  while (steady_clock::now() < end) {
    const auto read = steady_clock::now();
    EXPECT_TRUE(robot.GetMap("street").ok());
    reads_ms.push_back(Milliseconds(read));
    const auto asked = steady_clock::now();
    const Status answered = robot.Localize(query).status();
    EXPECT_TRUE(answered.ok()) << answered.ToString();
    queries_ms.push_back(Milliseconds(asked));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // a camera's pace
  }
  for (std::thread& starter : waiting) starter.join();
  std::printf("p99 of %zu reads %.1f ms, of as many queries %.1f ms\n", reads_ms.size(),
              Percentile99(reads_ms), Percentile99(queries_ms));
  EXPECT_LT(Percentile99(reads_ms), kMostMs);
  EXPECT_LT(Percentile99(queries_ms), kMostMs);

  const auto ended = steady_clock::now();
  EXPECT_EQ(robot.EndSession(query.session).status().reason(), "STORE_BUSY");
  EXPECT_LT(Milliseconds(ended), 1000.0 * kDeadline.count());
  const auto stopped = steady_clock::now();
  server.Stop(1);
  EXPECT_LT(Milliseconds(stopped), 10000.0);
}

}  // namespace
}  // namespace maploc::testing
