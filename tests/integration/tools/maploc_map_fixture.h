// A store with a map that one session drove, and maploc-map to ask about it.
#pragma once

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/contract/store/store_fixture.h"
#include "tests/support/run_binary.h"

namespace maploc::testing {

class MaplocMap : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = OpenSqliteStore(store_);
    ASSERT_TRUE(opened.ok());
    MapStore& store = **opened;
    key_ = GiveMap(store);
    ASSERT_TRUE(store.StartSession(OpenSession("s", key_)).ok());
    std::vector<Observation> seen;
    for (int i = 1; i <= 20; ++i) seen.push_back(Seen(i, 1, 100, 20, 20, 16));
    seen.push_back(Missed(21, 1));
    ASSERT_TRUE(store.EndSession("s", SessionEnd::kByRobot, 5000, seen).ok());
    ASSERT_TRUE(store.StartSession(OpenSession("open", key_, 2000)).ok());
  }
  // A session of `robot` that ended.
  void Drive(const std::string& id, const std::string& robot, const std::vector<Observation>& seen,
             std::int64_t start_unix_ns = 5000) {
    const auto store = OpenSqliteStore(store_).value();
    Session session = OpenSession(id, key_, start_unix_ns);
    session.robot = robot;
    ASSERT_TRUE(store->StartSession(session).ok());
    ASSERT_TRUE(store->EndSession(id, SessionEnd::kByRobot, start_unix_ns + 1000, seen).ok());
  }
  // $STORE stands for the store's path.
  Output Map(std::string arguments) {
    if (const auto at = arguments.find("$STORE"); at != std::string::npos) {
      arguments.replace(at, 6, store_);
    }
    return RunBinary("maploc-map " + arguments);
  }
  nlohmann::json Json(const std::string& arguments) {
    const Output run = Map(arguments + " --json");
    EXPECT_EQ(run.exit_code, 0) << run.error;
    EXPECT_EQ(run.error, "");
    const auto document = nlohmann::json::parse(run.out, nullptr, false);
    EXPECT_FALSE(document.is_discarded()) << run.out;
    return document;
  }
  void ExpectFails(const std::string& arguments, const std::string& cause) {
    ExpectFailed(Map(arguments), cause);
  }

  TemporaryFolder folder_;
  std::string store_ = folder_.File("campus.db");
  MapKey key_;
};

}  // namespace maploc::testing
