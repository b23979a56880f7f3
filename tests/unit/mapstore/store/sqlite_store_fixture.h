// A store on disk, and ways to look at it and to harm it behind its back.
#pragma once

#include <memory>
#include <string>

#include <gmock/gmock.h>

#include "mapstore/store/schema.h"
#include "mapstore/store/sqlite_database.h"
#include "tests/contract/store/store_fixture.h"
#include "tests/support/files.h"

namespace maploc::testing {

class SqliteStoreTest : public ::testing::Test {
 protected:
  std::unique_ptr<MapStore> Open() {
    auto store = OpenSqliteStore(path_);
    EXPECT_TRUE(store.ok()) << store.status().ToString();
    return store.ok() ? std::move(*store) : nullptr;
  }
  // Behind the store's back.
  void Execute(const std::string& sql) {
    auto database = SqliteDatabase::Open(path_, SqliteAccess::kWrite, 1000);
    ASSERT_TRUE(database.ok());
    const Status status = database->Execute("PRAGMA foreign_keys = OFF; " + sql);
    ASSERT_TRUE(status.ok()) << status.ToString();
  }
  std::int64_t Count(const std::string& table) {
    auto database = SqliteDatabase::Open(path_, SqliteAccess::kRead, 1000);
    SqliteStatement statement(*database, "SELECT COUNT(*) FROM " + table);
    EXPECT_TRUE(statement.Step().value());
    return statement.Int("COUNT(*)");
  }
  // Opening fails, names the file, and leaves its bytes and its folder as they were.
  Status ExpectRefused() {
    const std::string before = ReadFile(path_);
    const auto store = OpenSqliteStore(path_);
    EXPECT_FALSE(store.ok());
    EXPECT_THAT(store.status().message(), ::testing::HasSubstr(path_));
    EXPECT_EQ(ReadFile(path_), before);
    EXPECT_FALSE(std::filesystem::exists(path_ + "-wal"));
    return store.status();
  }
  void ExpectVerifyNames(const std::string& what) {
    const Status status = Open()->Verify();
    EXPECT_EQ(status.code(), StatusCode::kDataLoss);
    EXPECT_THAT(status.message(), ::testing::HasSubstr(what));
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.File("store.db");
};

}  // namespace maploc::testing
