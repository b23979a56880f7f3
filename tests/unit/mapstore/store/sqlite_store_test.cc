// What only the store on disk can get wrong: strange files, damage, deaths, other processes.
#include "mapstore/store/sqlite_store.h"

#include <array>
#include <csignal>
#include <thread>

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "mapstore/store/sqlite_import.h"
#include "tests/unit/mapstore/store/sqlite_store_fixture.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;

TEST_F(SqliteStoreTest, AFileThatIsNotADatabaseIsRefused) {
  WriteFile(path_, std::string(5000, 'x'));
  EXPECT_EQ(ExpectRefused().reason(), "INVALID_FILE");
  WriteFile(path_, "short");
  EXPECT_EQ(ExpectRefused().reason(), "INVALID_FILE");
}

TEST_F(SqliteStoreTest, AnotherApplicationsDatabaseIsRefused) {
  auto other = SqliteDatabase::Open(path_, SqliteAccess::kCreate, 1000);
  ASSERT_TRUE(other->Execute("CREATE TABLE cameras (id INTEGER)").ok());
  const Status status = ExpectRefused();
  EXPECT_EQ(status.reason(), "INVALID_FILE");
  EXPECT_THAT(status.message(), HasSubstr("another application"));
}

TEST_F(SqliteStoreTest, ANewerSchemaIsRefused) {
  Open();
  Execute("PRAGMA user_version = " + std::to_string(StoreSchemaVersion() + 1));
  EXPECT_EQ(ExpectRefused().reason(), "STORE_TOO_NEW");
}

TEST_F(SqliteStoreTest, AFolderOrAMissingFileIsRefused) {
  EXPECT_EQ(OpenSqliteStore(folder_.File("")).status().reason(), "INVALID_FILE");
  SqliteStoreOptions reading;
  reading.create = false;
  EXPECT_EQ(OpenSqliteStore(path_, reading).status().reason(), "STORE_NOT_FOUND");
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_EQ(OpenSqliteStore(folder_.File("no/such/store.db")).status().code(),
            StatusCode::kUnavailable);
}

TEST_F(SqliteStoreTest, AnEmptyFileBecomesAStore) {
  WriteFile(path_, "");
  SqliteStoreOptions reading;
  reading.create = false;
  EXPECT_FALSE(OpenSqliteStore(path_, reading).ok());
  EXPECT_TRUE(Open()->Verify().ok());
}

// For SQLite these are temporary databases: what is written there is gone.
TEST_F(SqliteStoreTest, NamesThatSqliteTakesForSomethingElseAreFilesOrRefused) {
  EXPECT_EQ(OpenSqliteStore("").status().code(), StatusCode::kInvalidArgument);
  const std::filesystem::path here = std::filesystem::current_path();
  std::filesystem::current_path(folder_.File(""));
  GiveMap(*OpenSqliteStore(":memory:").value());
  EXPECT_EQ(OpenSqliteStore(":memory:").value()->ListMaps()->size(), 1u);
  std::filesystem::current_path(here);
  EXPECT_TRUE(std::filesystem::exists(folder_.File(":memory:")));
}

TEST_F(SqliteStoreTest, ATruncatedStoreIsSaidToBe) {
  GiveMap(*Open());
  const std::string whole = ReadFile(path_);
  ASSERT_GT(whole.size(), 20000u);
  for (const std::size_t size : {std::size_t{150}, whole.size() / 3, whole.size() - 4096}) {
    WriteFile(path_, whole.substr(0, size));
    const auto store = OpenSqliteStore(path_);
    const Status status = store.ok() ? (*store)->Verify() : store.status();
    EXPECT_EQ(status.code(), StatusCode::kDataLoss) << size << ": " << status.ToString();
    EXPECT_THAT(status.message(), HasSubstr(path_));
  }
}

TEST_F(SqliteStoreTest, TheChangeCounterRisesForOtherProcesses) {
  const auto server = Open();
  const auto tool = Open();
  const std::int64_t before = server->ChangeCounter().value();
  const MapKey key = GiveMap(*tool);
  const std::int64_t imported = server->ChangeCounter().value();
  EXPECT_GT(imported, before);
  ASSERT_TRUE(tool->PinStrategy(key, 0, Strategy::k2P).ok());
  EXPECT_GT(server->ChangeCounter().value(), imported);
  EXPECT_EQ(server->GetSegment(key, 0)->decision.strategy, Strategy::k2P);
}

// A reader that began before a write sees what was there before, and does not wait for its end.
TEST_F(SqliteStoreTest, ReadersDoNotWaitForAWriter) {
  const auto store = Open();
  GiveMap(*store);
  auto writing = SqliteDatabase::Open(path_, SqliteAccess::kWrite, 0);
  auto transaction = SqliteTransaction::Begin(*writing, SqliteTransaction::Kind::kWrite);
  ASSERT_TRUE(transaction.ok());
  ASSERT_TRUE(writing->Execute("UPDATE map_versions SET metric = 0").ok());
  EXPECT_TRUE(store->GetMap("yard")->info.metric);
  EXPECT_TRUE(store->LoadSegment({"yard", 1}, 0).ok());
}

TEST_F(SqliteStoreTest, AWriterThatWaitsTooLongSaysSo) {
  Open();
  SqliteStoreOptions impatient;
  impatient.busy_timeout_ms = 1;
  const auto store = OpenSqliteStore(path_, impatient).value();
  auto writing = SqliteDatabase::Open(path_, SqliteAccess::kWrite, 0);
  auto transaction = SqliteTransaction::Begin(*writing, SqliteTransaction::Kind::kWrite);
  ASSERT_TRUE(transaction.ok());
  const Status status = store->BeginImport(YardInfo()).status();
  EXPECT_EQ(status.reason(), "STORE_BUSY");
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
}

TEST_F(SqliteStoreTest, ManyOpenAnEmptyStoreAtOnce) {
  std::vector<std::thread> openers;
  for (int i = 0; i < 6; ++i) {
    openers.emplace_back([&] {
      const auto store = OpenSqliteStore(path_);
      if (!store.ok()) ADD_FAILURE() << store.status().ToString();
    });
  }
  for (std::thread& opener : openers) opener.join();
  EXPECT_TRUE(Open()->Verify().ok());
}

// Runs `work` in a process of its own, which then lives until it is killed.
class Child {
 public:
  template <typename Work>
  explicit Child(Work work) {
    int ready[2];
    EXPECT_EQ(pipe(ready), 0);
    id_ = fork();
    if (id_ == 0) {
      work([&] {
        const char done = 1;
        if (write(ready[1], &done, 1) != 1) _exit(1);
        while (true) pause();
      });
      _exit(1);
    }
    close(ready[1]);
    char done = 0;
    EXPECT_EQ(read(ready[0], &done, 1), 1);
    close(ready[0]);
  }
  ~Child() { Kill(); }
  void Kill() {
    if (id_ <= 0) return;
    kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
    id_ = 0;
  }

 private:
  pid_t id_ = 0;
};

TEST_F(SqliteStoreTest, WhatAKilledImportLeftIsSweptButNotWhileItLives) {
  Open();
  Child importer([this](auto wait_for_death) {
    auto store = OpenSqliteStore(path_);
    auto writer = (*store)->BeginImport(YardInfo());
    if (!(*writer)->AddSegment(YardSegment(0)).ok()) _exit(1);
    if (!(*writer)->AddSegment(YardSegment(1)).ok()) _exit(1);
    wait_for_death();
  });
  SqliteStoreOptions server;
  server.sweep_abandoned_imports = true;
  ASSERT_TRUE(OpenSqliteStore(path_, server).ok());
  EXPECT_EQ(Count("segments"), 2);
  importer.Kill();
  EXPECT_TRUE(Open()->ListMaps()->empty());
  ASSERT_TRUE(OpenSqliteStore(path_, server).ok());
  EXPECT_EQ(Count("segments"), 0);
  EXPECT_EQ(Count("segment_features"), 0);
  EXPECT_EQ(Count("segment_places"), 0);
  EXPECT_EQ(Count("map_versions"), 0);
  EXPECT_EQ(GiveMap(*Open()).version, 1);
}

// Killed when all but the publishing was done, with the inherited statistics written down.
TEST_F(SqliteStoreTest, WhatAKilledImportInheritedIsSweptWithIt) {
  {
    const auto store = Open();
    const MapKey old = GiveMap(*store);
    ASSERT_TRUE(store->StartSession(OpenSession("s", old)).ok());
    ASSERT_TRUE(store->EndSession("s", SessionEnd::kByRobot, 5000, std::array{Seen(1, 0)}).ok());
    GiveMap(*store);
  }
  Execute("UPDATE map_versions SET state = 0, enabled_order = 0 WHERE version = 2");
  ASSERT_EQ(Count("segment_folds"), 2);
  const auto store = Open();
  const Status swept = store->SweepAbandonedImports();
  EXPECT_TRUE(swept.ok()) << swept.ToString();
  EXPECT_EQ(Count("segments"), 3);
  EXPECT_EQ(Count("segment_folds"), 1);
  EXPECT_TRUE(store->Verify().ok());
  EXPECT_EQ(GiveMap(*store).version, 2);
}

// Between a sweeper's look and its deleting another process may publish the import, or go on.
TEST_F(SqliteStoreTest, ALateSweepLeavesPublishedAndLivingImportsAlone) {
  const auto store = Open();
  GiveMap(*store);
  const auto living = store->BeginImport(YardInfo("living")).value();
  ASSERT_TRUE(living->AddSegment(YardSegment(0)).ok());
  const auto connections = SqliteConnections::Open(path_, {}).value();
  constexpr std::int64_t kPublishedRow = 1;
  constexpr std::int64_t kLivingRow = 2;
  EXPECT_TRUE(SweepSqliteImport(*connections, kPublishedRow).ok());
  EXPECT_TRUE(SweepSqliteImport(*connections, kLivingRow).ok());
  EXPECT_TRUE(living->Commit().ok());
  EXPECT_EQ(Count("segments"), 4);
  EXPECT_TRUE(store->Verify().ok());
}

TEST_F(SqliteStoreTest, ObservationsOfAKilledServerAreFoldedByTheNext) {
  const MapKey key = GiveMap(*Open());
  Child server([&](auto wait_for_death) {
    auto store = OpenSqliteStore(path_);
    if (!(*store)->StartSession(OpenSession("s", key)).ok()) _exit(1);
    if (!Append(**store, "s", std::vector{Seen(1, 0), Seen(2, 1)}).ok()) _exit(1);
    wait_for_death();
  });
  server.Kill();
  const auto store = Open();
  EXPECT_EQ(store->EndSession("s", SessionEnd::kIdle, 9, {})->queries, 2);
  EXPECT_EQ(store->GetSegment(key, 1)->statistics.queries, 1);
  EXPECT_TRUE(store->Verify().ok());
}

TEST_F(SqliteStoreTest, ABackupOfAStoreInUseIsWhole) {
  const auto store = Open();
  const MapKey key = GiveMap(*store);
  const std::string copy = folder_.File("copy.db");
  auto unfinished = store->BeginImport(YardInfo("half"));
  ASSERT_TRUE((*unfinished)->AddSegment(YardSegment(0)).ok());
  const Status status = BackupSqliteStore(path_, copy);
  ASSERT_TRUE(status.ok()) << status.ToString();
  const auto copied = OpenSqliteStore(copy).value();
  EXPECT_TRUE(copied->Verify().ok());
  EXPECT_EQ(copied->LoadSegment(key, 2).value()->points.ids, YardSegment(2).points.ids);
  EXPECT_EQ(copied->ListMaps()->size(), 1u);
  EXPECT_EQ(BackupSqliteStore(path_, copy).code(), StatusCode::kAlreadyExists);
  EXPECT_EQ(BackupSqliteStore(folder_.File("none.db"), folder_.File("b.db")).code(),
            StatusCode::kNotFound);
  EXPECT_EQ(BackupSqliteStore(path_, folder_.File("no/copy.db")).code(), StatusCode::kUnavailable);
}

// A megabyte and more, behind which another map stands: pages have to move.
TEST_F(SqliteStoreTest, ADeletedVersionGivesItsSpaceBackWhileAnotherProcessReadsAndWrites) {
  const auto pages = [this] {
    auto database = SqliteDatabase::Open(path_, SqliteAccess::kRead, 1000).value();
    SqliteStatement count(database, "PRAGMA page_count");
    EXPECT_TRUE(count.Step().value());
    return count.Int("page_count");
  };
  constexpr int kPageBytes = 4096;
  const auto served = Open();
  GiveMap(*served, "yard", 40);
  const std::int64_t with_one = pages();
  GiveMap(*served, "yard", 40);
  const MapKey garden = GiveMap(*served, "garden", 3);
  const std::int64_t with_all = pages();
  const auto store = Open();
  ASSERT_TRUE(store->DeleteVersion({"yard", 1}).ok());
  EXPECT_LT(pages(), with_all - with_one / 2);
  EXPECT_EQ(std::filesystem::file_size(path_), pages() * kPageBytes) << "nothing waits in the log";
  EXPECT_EQ(Count("pragma_freelist_count WHERE freelist_count > 0"), 0);
  EXPECT_TRUE(served->LoadSegment(garden, 2).ok());
  ASSERT_TRUE(served->StartSession(OpenSession("after", garden)).ok());
  EXPECT_TRUE(served->Verify().ok()) << served->Verify().ToString();
}

}  // namespace
}  // namespace maploc::testing
