// A store that is moved, deleted or written over under a running program: nothing is acknowledged
// any more, and neither file is harmed.
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>

#include "tests/unit/mapstore/store/sqlite_store_fixture.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;

class SqliteIdentityTest : public SqliteStoreTest {
 protected:
  SqliteIdentityTest() { key_ = GiveMap(*Open()); }

  std::string Backup() {
    const std::string to = folder_.File("backup.db");
    const Status status = BackupSqliteStore(path_, to);
    EXPECT_TRUE(status.ok()) << status.ToString();
    return to;
  }
  // As cp does: the same file, another content.
  void Copy(const std::string& from, const std::string& to) {
    std::ofstream(to, std::ios::binary | std::ios::trunc) << ReadFile(from);
  }
  // File and log as a kill leaves them.
  void CopyAsKilled(const std::string& to) {
    Copy(path_, to);
    Copy(path_ + "-wal", to + "-wal");
  }
  Status Start(MapStore& store, const SessionId& id) {
    return store.StartSession(OpenSession(id, key_));
  }
  void ExpectReplaced(MapStore& store, const std::string& how) {
    for (const Status& status :
         {Start(store, "late"), store.ChangeCounter().status(), store.CheckIdentity()}) {
      EXPECT_EQ(status.code(), StatusCode::kUnavailable);
      EXPECT_EQ(status.reason(), "STORE_REPLACED");
      EXPECT_THAT(status.message(), HasSubstr(how));
    }
  }
  void ExpectVerifies(const std::string& path, std::size_t sessions) {
    const auto store = OpenSqliteStore(path);
    ASSERT_TRUE(store.ok()) << store.status().ToString();
    const Status status = (*store)->Verify();
    EXPECT_TRUE(status.ok()) << status.ToString();
    EXPECT_EQ((*store)->ListSessions()->size(), sessions);
  }

  MapKey key_;
};

TEST_F(SqliteIdentityTest, AFileThatIsMovedOverTheStoreIsLeftWhole) {
  auto store = Open();
  ASSERT_TRUE(Start(*store, "before").ok());
  const std::string backup = Backup();
  ASSERT_TRUE(Start(*store, "after").ok());
  ASSERT_EQ(std::rename(backup.c_str(), path_.c_str()), 0);
  ExpectReplaced(*store, "replaced by another file");
  ExpectVerifies(path_, 1);  // also while the other program is there
  store.reset();
  ExpectVerifies(path_, 1);
}

// Also between two of its looks at the file. What it had acknowledged is in its log, which belongs
// to the file that went.
TEST_F(SqliteIdentityTest, AFileThatIsMovedOverTheStoreAtAnyMomentCostsNothing) {
  for (int i = 0; i < 20 && !HasFailure(); ++i) {
    const std::string backup = Backup();
    const std::string old = folder_.File("old" + std::to_string(i));
    auto store = Open();
    std::filesystem::create_hard_link(path_, old);
    std::atomic<int> started = 0;
    Status refused;
    std::thread robots([&] {
      while (refused.ok()) {
        refused = Start(*store, std::to_string(i) + "-" + std::to_string(started));
        if (refused.ok()) ++started;
      }
    });
    std::thread other([&] {  // folds the log, so that each look reads the file's content
      auto database = SqliteDatabase::Open(path_, SqliteAccess::kWrite, 1000);
      while (started < 5 + i) static_cast<void>(database->Execute("PRAGMA wal_checkpoint"));
    });
    other.join();
    ASSERT_EQ(std::rename(backup.c_str(), path_.c_str()), 0);
    robots.join();
    EXPECT_THAT(refused.message(), HasSubstr("replaced by another file"));
    store.reset();
    const auto kept = OpenSqliteStore(old);
    ASSERT_TRUE(kept.ok()) << kept.status().ToString();
    EXPECT_GE((*kept)->ListSessions()->size(), static_cast<std::size_t>(started));
  }
}

// A map that loads reads for seconds.
TEST_F(SqliteIdentityTest, ALogThatAReaderHoldsIsPutAwayAfterwards) {
  const std::string backup = Backup();
  auto store = Open();
  ASSERT_TRUE(Start(*store, "before").ok());
  auto reader = SqliteDatabase::Open(path_, SqliteAccess::kRead, 0);
  ASSERT_TRUE(reader.ok()) << reader.status().ToString();
  auto reading = SqliteTransaction::Begin(*reader, SqliteTransaction::Kind::kRead);
  ASSERT_TRUE(reading.ok()) << reading.status().ToString();
  ASSERT_TRUE(SqliteStatement(*reader, "SELECT name FROM meta").Step().value());
  ASSERT_TRUE(Start(*store, "after").ok());
  ASSERT_EQ(std::rename(backup.c_str(), path_.c_str()), 0);
  ExpectReplaced(*store, "replaced by another file");
  EXPECT_GT(std::filesystem::file_size(path_ + "-wal"), 0u);
  { const SqliteTransaction done = std::move(*reading); }
  ExpectReplaced(*store, "replaced by another file");
  EXPECT_EQ(std::filesystem::file_size(path_ + "-wal"), 0u);
  ExpectVerifies(path_, 0);
}

TEST_F(SqliteIdentityTest, AStoreThatWasMovedAwayTakesItsLogAlong) {
  auto store = Open();
  ASSERT_TRUE(Start(*store, "before").ok());
  const std::string away = folder_.File("away.db");
  ASSERT_EQ(std::rename(path_.c_str(), away.c_str()), 0);
  ExpectReplaced(*store, "deleted or moved away");
  store.reset();
  ExpectVerifies(away, 1);
}

TEST_F(SqliteIdentityTest, ACopyOverTheStoreIsNoticedAndNotWrittenTo) {
  const std::string backup = Backup();
  auto store = Open();
  ASSERT_TRUE(Start(*store, "before").ok());
  Copy(backup, path_);
  ExpectReplaced(*store, "was written over");
  store.reset();
  EXPECT_EQ(ReadFile(path_), ReadFile(backup));
}

TEST_F(SqliteIdentityTest, AnOlderStateOfTheStoreItselfIsNoticedToo) {
  const std::string copy = folder_.File("copy.db");
  Copy(path_, copy);
  ASSERT_TRUE(Start(*Open(), "between").ok());
  auto store = Open();
  ASSERT_TRUE(Start(*store, "before").ok());
  Copy(copy, path_);
  ExpectReplaced(*store, "was written over");
}

TEST_F(SqliteIdentityTest, ALogThatWasRemovedIsNoticedAndItsContentKept) {
  auto store = Open();
  ASSERT_TRUE(Start(*store, "before").ok());
  ASSERT_EQ(std::remove((path_ + "-wal").c_str()), 0);
  ExpectReplaced(*store, "-wal, which was deleted or replaced");
  store.reset();
  ASSERT_EQ(std::remove((path_ + "-shm").c_str()), 0);
  ExpectVerifies(path_, 1);
}

TEST_F(SqliteIdentityTest, FoldedLogsAreNoReplacement) {
  const auto store = Open();
  const auto other = Open();
  for (int i = 0; i < 20; ++i) {
    const Status status = Start(*(i % 2 == 0 ? store : other), "session-" + std::to_string(i));
    ASSERT_TRUE(status.ok()) << status.ToString();
    if (i % 3 == 0) Execute("PRAGMA wal_checkpoint(TRUNCATE)");
  }
  ASSERT_TRUE(GiveMap(*store, "large", 40).version > 0);  // folds of itself
  EXPECT_TRUE(store->Verify().ok());
  EXPECT_TRUE(other->CheckIdentity().ok());
}

TEST_F(SqliteIdentityTest, AKilledServersOwnLogIsReplayed) {
  const auto store = Open();
  ASSERT_TRUE(Start(*store, "before").ok());
  CopyAsKilled(folder_.File("killed.db"));
  ExpectVerifies(folder_.File("killed.db"), 1);
}

// The damage of old: five of five.
TEST_F(SqliteIdentityTest, ALogOfAnotherFileIsRefusedAndHarmsNothing) {
  const std::string old = folder_.File("old.db");
  Copy(path_, old);  // by hand, while nobody used it
  ASSERT_TRUE(Start(*Open(), "between").ok());
  const std::string backup = Backup();
  const auto store = Open();
  ASSERT_TRUE(Start(*store, "before").ok());
  for (const std::string& from : {old, backup}) {
    const std::string killed = folder_.File("killed.db");
    CopyAsKilled(killed);
    Copy(from, killed);
    const Status status = OpenSqliteStore(killed).status();
    EXPECT_EQ(status.reason(), "FOREIGN_LOG") << from;
    EXPECT_THAT(status.message(), HasSubstr("maploc-map restore --store " + killed));
    EXPECT_EQ(ReadFile(killed), ReadFile(from));
  }
}

TEST_F(SqliteIdentityTest, AStoreFromBeforeStampsGetsOne) {
  Execute("DELETE FROM meta WHERE name = 'commit_stamp'");
  const std::string backup = Backup();
  auto store = Open();
  ASSERT_TRUE(Start(*store, "before").ok());
  Copy(backup, path_);
  ExpectReplaced(*store, "was written over");
}

}  // namespace
}  // namespace maploc::testing
