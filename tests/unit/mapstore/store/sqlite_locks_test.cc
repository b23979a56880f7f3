// Locks that must hold however often, and by whatever name, a store is opened.
#include <functional>

#include <sys/wait.h>
#include <unistd.h>

#include "mapstore/store/import_lock.h"
#include "mapstore/store/sqlite_file.h"
#include "tests/unit/mapstore/store/sqlite_store_fixture.h"

namespace maploc::testing {
namespace {

// A process that knows nothing of this one's connections: it is forked before there are any, and
// waits to be let go.
class Stranger {
 public:
  explicit Stranger(const std::function<bool()>& work) {
    EXPECT_EQ(pipe(pipe_), 0);
    pid_ = fork();
    if (pid_ != 0) return;
    char go = 0;
    const bool told = read(pipe_[0], &go, 1) == 1;
    _exit(told && work() ? 0 : 1);
  }
  void Work() {
    ASSERT_EQ(write(pipe_[1], "g", 1), 1);
    int status = 0;
    waitpid(pid_, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    close(pipe_[0]);
    close(pipe_[1]);
  }

 private:
  int pipe_[2] = {-1, -1};
  pid_t pid_ = 0;
};

// A process that finds no lock takes itself for the last user and puts the log away.
class SqliteLocksTest : public SqliteStoreTest {
 protected:
  void ExpectStillLocked(const std::function<void()>& look) {
    Stranger other([this] { return OpenSqliteStore(path_).ok(); });
    const std::unique_ptr<MapStore> store = Open();
    look();
    other.Work();
    const Status status = store->CheckIdentity();
    EXPECT_TRUE(status.ok()) << status.ToString();
    EXPECT_TRUE(std::filesystem::exists(path_ + "-wal"));
  }
};

TEST_F(SqliteLocksTest, OpeningAStoreOnceMoreLetsNoneGo) {
  ExpectStillLocked([this] { Open(); });
}

TEST_F(SqliteLocksTest, ALookAtItsHeaderLetsNoneGo) {
  ExpectStillLocked([this] { EXPECT_TRUE(CheckStoreFile(path_).ok()); });
}

TEST_F(SqliteLocksTest, ABackupOfItLetsNoneGo) {
  ExpectStillLocked(
      [this] { EXPECT_TRUE(BackupSqliteStore(path_, folder_.File("backup.db")).ok()); });
}

TEST(ImportLockTest, HoldsByWhateverNameTheStoreIsOpened) {
  const TemporaryFolder folder;
  folder.Write("store", "");
  std::filesystem::create_symlink("store", folder.File("link"));
  {
    const auto by_name = ImportLock::Acquire(folder.File("store"), 7);
    ASSERT_TRUE(by_name.ok());
    EXPECT_TRUE(ImportLock::IsHeld(folder.File("link"), 7).value());
    EXPECT_TRUE(ImportLock::IsAnyHeld(folder.File("link")).value());
  }
  const auto by_link = ImportLock::Acquire(folder.File("link"), 8);
  ASSERT_TRUE(by_link.ok());
  EXPECT_TRUE(ImportLock::IsHeld(folder.File("store"), 8).value());
  EXPECT_FALSE(ImportLock::IsHeld(folder.File("store"), 7).value());
}

}  // namespace
}  // namespace maploc::testing
