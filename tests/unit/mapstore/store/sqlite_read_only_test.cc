// A store where this user may not write: a medium that is read-only, another user's folder.
#include <sys/stat.h>
#include <unistd.h>

#include "tests/unit/mapstore/store/sqlite_store_fixture.h"

namespace maploc::testing {
namespace {

constexpr uid_t kNobody = 65534;

class SqliteReadOnlyTest : public SqliteStoreTest {
 protected:
  SqliteReadOnlyTest() {
    GiveMap(*Open());
    chmod(path_.c_str(), 0444);
    chmod(folder_.path().c_str(), 0555);
  }
  ~SqliteReadOnlyTest() override { chmod(folder_.path().c_str(), 0755); }

  // Root may write anywhere; as root the look is taken in a process that is nobody.
  template <typename Look>
  void ExpectAsReader(const Look& look) {
    EXPECT_EXIT(
        {
          const bool reader = geteuid() != 0 || seteuid(kNobody) == 0;
          const std::string failure = reader ? look() : "cannot become nobody";
          std::fputs(failure.c_str(), stderr);
          _exit(failure.empty() ? 0 : 1);
        },
        ::testing::ExitedWithCode(0), "");
  }
  int FilesBeside() const {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      count += entry.is_regular_file() ? 1 : 0;
    }
    return count;
  }
};

TEST_F(SqliteReadOnlyTest, IsReadAndNothingAppearsBesideIt) {
  const TemporaryFolder elsewhere;
  chmod(elsewhere.path().c_str(), 0777);
  const int files = FilesBeside();
  ExpectAsReader([&]() -> std::string {
    if (CanWriteStore(path_)) return "it says that it can write";
    auto store = OpenSqliteStore(path_);
    if (!store.ok()) return store.status().ToString();
    if ((*store)->ListMaps().value().size() != 1) return "no map";
    if (const Status status = (*store)->Verify(); !status.ok()) return status.ToString();
    return BackupSqliteStore(path_, elsewhere.File("copy.db")).ToString().substr(2);
  });
  EXPECT_EQ(FilesBeside(), files);
  EXPECT_TRUE(OpenSqliteStore(elsewhere.File("copy.db")).value()->Verify().ok());
}

TEST_F(SqliteReadOnlyTest, WhatWouldChangeItIsRefusedByName) {
  ExpectAsReader([&]() -> std::string {
    auto store = OpenSqliteStore(path_);
    if (!store.ok()) return store.status().ToString();
    const MapKey key = (*store)->ListMaps().value().front().info.key;
    const Status status = (*store)->PinStrategy(key, 0, Strategy::k2P);
    return status.reason() == "STORE_READ_ONLY" ? "" : status.ToString();
  });
}

// The server runs as another user, and has committed what is only in its log as yet.
TEST_F(SqliteReadOnlyTest, ALiveStoreIsReadAsItsServerLastLeftIt) {
  chmod(folder_.path().c_str(), 0755);
  chmod(path_.c_str(), 0644);
  const std::unique_ptr<MapStore> live = Open();
  const MapKey key = live->ListMaps().value().front().info.key;
  ASSERT_TRUE(live->PinStrategy(key, 0, Strategy::k2P).ok());
  ASSERT_GT(std::filesystem::file_size(path_ + "-wal"), 0u);
  for (const std::string suffix : {"", "-wal", "-shm"}) chmod((path_ + suffix).c_str(), 0444);
  chmod(folder_.path().c_str(), 0555);
  ExpectAsReader([&]() -> std::string {
    auto store = OpenSqliteStore(path_);
    if (!store.ok()) return store.status().ToString();
    const auto segment = (*store)->GetSegment(key, 0);
    if (!segment.ok()) return segment.status().ToString();
    return segment->pinned == Strategy::k2P ? "" : "an older state";
  });
}

TEST_F(SqliteReadOnlyTest, AnOlderVersionsStoreIsRefusedWithTheCure) {
  chmod(folder_.path().c_str(), 0755);
  chmod(path_.c_str(), 0644);
  Execute("PRAGMA user_version = " + std::to_string(StoreSchemaVersion() - 1));
  chmod(path_.c_str(), 0444);
  chmod(folder_.path().c_str(), 0555);
  ExpectAsReader([&]() -> std::string {
    const Status status = OpenSqliteStore(path_).status();
    return status.reason() == "STORE_TOO_OLD" ? "" : status.ToString();
  });
}

}  // namespace
}  // namespace maploc::testing
