// A backup takes a store's place, or the store stays as it was.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

#include "mapstore/store/restore.h"
#include "mapstore/store/serve_lock.h"
#include "tests/unit/mapstore/store/no_links.h"
#include "tests/unit/mapstore/store/sqlite_store_fixture.h"

namespace maploc::testing {
namespace {

using ::testing::StartsWith;

class SqliteRestoreTest : public SqliteStoreTest {
 protected:
  SqliteRestoreTest() {
    const auto store = Open();
    key_ = GiveMap(*store);
    Start(*store, "before");
    EXPECT_TRUE(BackupSqliteStore(path_, backup_).ok());
    Start(*store, "after");
    GiveMap(*store);
    GiveMap(*store, "garden");
  }

  void Start(MapStore& store, const SessionId& id) {
    EXPECT_TRUE(store.StartSession(OpenSession(id, key_)).ok());
  }
  void ExpectRestored() {
    const Result<RestoredStore> restored = RestoreSqliteStore(path_, backup_);
    ASSERT_TRUE(restored.ok()) << restored.status().ToString();
    EXPECT_EQ(restored->maps, 1);
    EXPECT_EQ(restored->versions, 1);
    EXPECT_EQ(restored->sessions, 1);
    ExpectNothingBeside();
    EXPECT_TRUE(Open()->Verify().ok());
    EXPECT_EQ(Open()->ListSessions()->size(), 1u);
  }
  // Refused, with the old store as it was.
  void ExpectRefused(const std::string& reason, const std::string& from) {
    const std::string before = ReadFile(path_);
    const Status status = RestoreSqliteStore(path_, from).status();
    EXPECT_EQ(status.reason(), reason) << status.ToString();
    EXPECT_EQ(ReadFile(path_), before);
    EXPECT_EQ(Open()->ListSessions()->size(), 2u);
  }
  void ExpectNothingBeside() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename();
      EXPECT_TRUE(name == "store.db" || name == "backup.db" || name == "store.db-imports" ||
                  name == "store.db-server")
          << name;
    }
  }

  const std::string backup_ = folder_.File("backup.db");
  MapKey key_;
};

TEST_F(SqliteRestoreTest, TheBackupTakesTheStoresPlaceAndStaysAsItIs) {
  const std::string before = ReadFile(backup_);
  ExpectRestored();
  EXPECT_EQ(ReadFile(backup_), before);
}

TEST_F(SqliteRestoreTest, AStoreThatIsGoneIsRestoredToo) {
  std::filesystem::remove(path_);
  ExpectRestored();
}

TEST_F(SqliteRestoreTest, ADamagedStoreAndALogOfAnotherFileAreNoHindrance) {
  {
    const auto store = Open();
    Start(*store, "killed");
    WriteFile(folder_.File("log"), ReadFile(path_ + "-wal"));
  }
  WriteFile(path_, "no store");
  std::filesystem::rename(folder_.File("log"), path_ + "-wal");
  ExpectRestored();
}

TEST_F(SqliteRestoreTest, ALinkToTheStoreStaysALink) {
  const std::string link = folder_.File("link.db");
  std::filesystem::create_symlink(path_, link);
  ASSERT_TRUE(RestoreSqliteStore(link, backup_).ok());
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(Open()->ListSessions()->size(), 1u);
}

// The log of a store that is open lies beside the file, not beside a link to it.
TEST_F(SqliteRestoreTest, ALinkToAnOpenStoreIsReadWithItsLog) {
  const auto live = OpenSqliteStore(backup_).value();
  Start(*live, "in-the-log");
  const std::string link = folder_.File("latest.db");
  std::filesystem::create_symlink(backup_, link);
  const Result<RestoredStore> restored = RestoreSqliteStore(path_, link);
  ASSERT_TRUE(restored.ok()) << restored.status().ToString();
  EXPECT_EQ(restored->sessions, 2);
}

TEST_F(SqliteRestoreTest, WithoutHardLinksItIsRestoredToo) {
  const NoLinks vfat;
  ExpectRestored();
  std::filesystem::remove(path_);
  ExpectRestored();
}

// The store's log cannot be set aside, because a folder has the name that it would get.
class SqliteRestoreFailsTest : public SqliteRestoreTest {
 protected:
  SqliteRestoreFailsTest() {
    WriteFile(path_ + "-wal", "");
    std::filesystem::create_directories(path_ + ".replaced-" + std::to_string(getpid()) +
                                        "-wal/stone");
  }
  const std::string link_ = folder_.File("link.db");
};

TEST_F(SqliteRestoreFailsTest, TheOldStoreStays) { ExpectRefused("RESTORE_FAILED", backup_); }

TEST_F(SqliteRestoreFailsTest, TheOldStoreStaysWithoutLinksToo) {
  const NoLinks vfat;
  ExpectRefused("RESTORE_FAILED", backup_);
}

TEST_F(SqliteRestoreFailsTest, TheMessageNamesTheStoreAsTheUserDoes) {
  std::filesystem::create_symlink(path_, link_);
  EXPECT_THAT(RestoreSqliteStore(link_, backup_).status().message(), StartsWith(link_ + ": "));
}

TEST_F(SqliteRestoreTest, TheOldFilesPermissionsStay) {
  std::filesystem::permissions(path_, std::filesystem::perms::owner_all);
  ExpectRestored();
  EXPECT_EQ(std::filesystem::status(path_).permissions(), std::filesystem::perms::owner_all);
}

TEST_F(SqliteRestoreTest, AStoreInUseIsRefused) {
  {
    const Result<ServeLock> server = ServeLock::Acquire(path_);
    ASSERT_TRUE(server.ok());
    ExpectRefused("STORE_IN_USE", backup_);
  }
  const auto store = Open();
  const auto import = store->BeginImport(YardInfo("half")).value();
  ExpectRefused("STORE_IN_USE", backup_);
}

TEST_F(SqliteRestoreTest, ABackupThatDoesNotVerifyIsRefused) {
  const std::string bad = folder_.File("bad.db");
  WriteFile(bad, ReadFile(backup_));
  {
    auto database = SqliteDatabase::Open(bad, SqliteAccess::kWrite, 1000);
    ASSERT_TRUE(database->Execute("UPDATE segment_features SET checksum = 0").ok());
  }
  ExpectRefused("DAMAGED_SEGMENT", bad);
  WriteFile(bad, ReadFile(backup_).substr(0, 20000));
  EXPECT_FALSE(RestoreSqliteStore(path_, bad).ok());
  WriteFile(bad, "a letter");
  ExpectRefused("INVALID_FILE", bad);
  ExpectRefused("STORE_NOT_FOUND", folder_.File("none.db"));
  ExpectRefused("INVALID_FIELD", path_);
}

}  // namespace
}  // namespace maploc::testing
