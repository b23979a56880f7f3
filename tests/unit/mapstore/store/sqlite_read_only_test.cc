// A store where this user may not write: a medium that is read-only, another user's folder.
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "mapstore/store/sqlite_backup.h"
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
  // Of a look: what the owner does meanwhile in a process of its own, which then ends as by a
  // crash.
  template <typename Change>
  void AsOwner(const Change& change) {
    const pid_t owner = fork();
    if (owner != 0) {
      waitpid(owner, nullptr, 0);
      return;
    }
    static_cast<void>(seteuid(getuid()));
    chmod(folder_.path().c_str(), 0755);
    chmod(path_.c_str(), 0644);
    change();
    chmod(folder_.path().c_str(), 0555);
    _exit(0);
  }
  // Leaves a log, which only a program that ends well takes into the file.
  void PinAndCrash() {
    MapStore* store = OpenSqliteStore(path_)->release();
    const MapKey key = store->ListMaps()->front().info.key;
    static_cast<void>(store->PinStrategy(key, 0, Strategy::k2P));
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

// The link's folder holds no log; the store's does.
TEST_F(SqliteReadOnlyTest, ALiveStoreIsReadThroughALinkToo) {
  const TemporaryFolder elsewhere;
  chmod(elsewhere.path().c_str(), 0755);
  const std::string link = elsewhere.File("link");
  std::filesystem::create_symlink(path_, link);
  ExpectAsReader([&]() -> std::string {
    AsOwner([&] { PinAndCrash(); });
    auto store = OpenSqliteStore(link);
    if (!store.ok()) return store.status().ToString();
    const MapKey key = (*store)->ListMaps()->front().info.key;
    const auto segment = (*store)->GetSegment(key, 0);
    if (!segment.ok()) return segment.status().ToString();
    return segment->pinned == Strategy::k2P ? "" : "an older state";
  });
}

TEST_F(SqliteReadOnlyTest, WhatItsOwnerChangesMeanwhileIsToldAndReadByOpeningAnew) {
  ExpectAsReader([&]() -> std::string {
    auto store = OpenSqliteStore(path_);
    if (!store.ok()) return store.status().ToString();
    if (!(*store)->ListMaps().ok()) return "it is not read";
    AsOwner([&] { GiveMap(**OpenSqliteStore(path_), "garden"); });
    for (const Status& status :
         {(*store)->ListMaps().status(), (*store)->CheckIdentity(), (*store)->Verify()}) {
      if (status.reason() != "STORE_REPLACED") return status.ToString();
    }
    auto anew = OpenSqliteStore(path_);
    if (!anew.ok()) return anew.status().ToString();
    return (*anew)->ListMaps()->size() == 2 ? "" : "an older state";
  });
}

TEST_F(SqliteReadOnlyTest, ALogThatItsOwnerBeginsMeanwhileIsTold) {
  ExpectAsReader([&]() -> std::string {
    auto store = OpenSqliteStore(path_);
    if (!store.ok()) return store.status().ToString();
    AsOwner([&] { PinAndCrash(); });
    const Status status = (*store)->ListMaps().status();
    return status.reason() == "STORE_REPLACED" ? "" : status.ToString();
  });
}

// Without locks nothing keeps the owner from writing while pages are copied.
TEST_F(SqliteReadOnlyTest, NoCopyIsMadeOfAFileThatItsOwnerChangesMeanwhile) {
  auto source = SqliteDatabase::Open(path_, SqliteAccess::kFileAlone, 0).value();
  AsOwner([&] { GiveMap(**OpenSqliteStore(path_), "garden"); });
  const TemporaryFolder elsewhere;
  EXPECT_EQ(CopyStore(source, elsewhere.File("copy")).reason(), "STORE_REPLACED");
}

TEST_F(SqliteReadOnlyTest, AStoreThatItsOwnerMovesAwayIsTold) {
  ExpectAsReader([&]() -> std::string {
    auto store = OpenSqliteStore(path_);
    if (!store.ok()) return store.status().ToString();
    AsOwner([&] { std::filesystem::rename(path_, path_ + ".away"); });
    const Status status = (*store)->ListMaps().status();
    return status.reason() == "STORE_REPLACED" ? "" : status.ToString();
  });
}

// A crash leaves the log, a copy of the folder its index behind; without one the log cannot be
// read.
TEST_F(SqliteReadOnlyTest, ALogWithoutItsIndexIsNamedWithTheCure) {
  ExpectAsReader([&]() -> std::string {
    AsOwner([&] {
      PinAndCrash();
      std::filesystem::remove(path_ + "-shm");
    });
    const Status status = OpenSqliteStore(path_).status();
    if (status.message().find("for writing") != std::string::npos) return status.ToString();
    if (status.message().find(path_ + "-wal") == std::string::npos) return status.ToString();
    return status.reason() == "STORE_NOT_WRITABLE" ? "" : status.ToString();
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

// For whoever may write there and only wants to read, as `import --from` does.
TEST_F(SqliteStoreTest, OpenedForReadingAStoreKeepsItsBytesAndRefusesChanges) {
  GiveMap(*Open());
  SqliteStoreOptions reading;
  reading.read_only = true;
  const std::string before = ReadFile(path_);
  {
    const auto store = OpenSqliteStore(path_, reading);
    ASSERT_TRUE(store.ok()) << store.status().ToString();
    const MapKey key = (*store)->ListMaps()->front().info.key;
    EXPECT_TRUE((*store)->LoadSegment(key, 0).ok());
    EXPECT_EQ((*store)->PinStrategy(key, 0, Strategy::k2P).reason(), "STORE_READ_ONLY");
  }
  EXPECT_EQ(ReadFile(path_), before);
  for (const char* suffix : {"-wal", "-shm"}) {
    EXPECT_FALSE(std::filesystem::exists(path_ + suffix)) << suffix;
  }
  const std::unique_ptr<MapStore> live = Open();
  const MapKey key = live->ListMaps()->front().info.key;
  ASSERT_TRUE(live->PinStrategy(key, 0, Strategy::k2P).ok());
  EXPECT_EQ(OpenSqliteStore(path_, reading).value()->GetSegment(key, 0)->pinned, Strategy::k2P);
}

TEST_F(SqliteStoreTest, OpenedForReadingAnOlderVersionsStoreKeepsItsBytes) {
  Open();
  Execute("PRAGMA user_version = " + std::to_string(StoreSchemaVersion() - 1));
  SqliteStoreOptions reading;
  reading.read_only = true;
  const std::string before = ReadFile(path_);
  const Status status = OpenSqliteStore(path_, reading).status();
  EXPECT_EQ(status.reason(), "STORE_TOO_OLD");
  EXPECT_THAT(status.message(), ::testing::HasSubstr("cp"));
  EXPECT_EQ(ReadFile(path_), before);
}

}  // namespace
}  // namespace maploc::testing
