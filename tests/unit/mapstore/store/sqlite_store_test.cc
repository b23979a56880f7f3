// What only the store on disk can get wrong: strange files, damage, deaths, other processes.
#include "mapstore/store/sqlite_store.h"

#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "mapstore/store/schema.h"
#include "mapstore/store/sqlite_database.h"
#include "mapstore/store/sqlite_import.h"
#include "tests/contract/store/store_fixture.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;

std::string ReadBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void WriteBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

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
    return statement.Int(0);
  }
  // Opening fails, names the file, and leaves its bytes and its folder as they were.
  Status ExpectRefused() {
    const std::string before = ReadBytes(path_);
    const auto store = OpenSqliteStore(path_);
    EXPECT_FALSE(store.ok());
    EXPECT_THAT(store.status().message(), HasSubstr(path_));
    EXPECT_EQ(ReadBytes(path_), before);
    EXPECT_FALSE(std::filesystem::exists(path_ + "-wal"));
    return store.status();
  }
  void ExpectVerifyNames(const std::string& what) {
    const Status status = Open()->Verify();
    EXPECT_EQ(status.code(), StatusCode::kDataLoss);
    EXPECT_THAT(status.message(), HasSubstr(what));
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.File("store.db");
};

TEST_F(SqliteStoreTest, AFileThatIsNotADatabaseIsRefused) {
  WriteBytes(path_, std::string(5000, 'x'));
  EXPECT_EQ(ExpectRefused().reason(), "INVALID_FILE");
  WriteBytes(path_, "short");
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
  WriteBytes(path_, "");
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
  const std::string whole = ReadBytes(path_);
  ASSERT_GT(whole.size(), 20000u);
  for (const std::size_t size : {std::size_t{150}, whole.size() / 3, whole.size() - 4096}) {
    WriteBytes(path_, whole.substr(0, size));
    const auto store = OpenSqliteStore(path_);
    const Status status = store.ok() ? (*store)->Verify() : store.status();
    EXPECT_EQ(status.code(), StatusCode::kDataLoss) << size << ": " << status.ToString();
    EXPECT_THAT(status.message(), HasSubstr(path_));
  }
}

TEST_F(SqliteStoreTest, ADamagedBlobIsNamedAndNotServed) {
  const MapKey key = GiveMap(*Open());
  Execute(
      "UPDATE segment_features SET geometry = substr(geometry, 1, length(geometry) - 8) "
      "WHERE segment = 1 AND type = 1");
  const auto store = Open();
  const Status status = store->LoadSegment(key, 1).status();
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_THAT(status.message(), HasSubstr("segment 1: points.positions"));
  EXPECT_TRUE(store->LoadSegment(key, 0).ok());
  ExpectVerifyNames("segment 1: points.positions");
}

TEST_F(SqliteStoreTest, AFlippedByteIsFound) {
  const MapKey key = GiveMap(*Open());
  Execute(
      "UPDATE segment_features SET descriptors = zeroblob(length(descriptors)) "
      "WHERE segment = 2 AND type = 2");
  EXPECT_EQ(Open()->LoadSegment(key, 2).status().code(), StatusCode::kDataLoss);
  ExpectVerifyNames("segment 2: lines: the checksum");
}

TEST_F(SqliteStoreTest, ACountBeyondReasonAllocatesNothing) {
  const MapKey key = GiveMap(*Open());
  Execute("UPDATE segment_features SET landmark_count = 4611686018427387904 WHERE segment = 0");
  EXPECT_EQ(Open()->LoadSegment(key, 0).status().code(), StatusCode::kDataLoss);
}

TEST_F(SqliteStoreTest, AMissingSegmentIsFound) {
  GiveMap(*Open());
  Execute("DELETE FROM segment_features WHERE segment = 1; DELETE FROM segments WHERE segment = 1");
  ExpectVerifyNames("count of segments");
}

TEST_F(SqliteStoreTest, TamperedStatisticsAreFound) {
  {
    const auto store = Open();
    const MapKey key = GiveMap(*store);
    ASSERT_TRUE(store->StartSession(OpenSession("s", key)).ok());
    ASSERT_TRUE(store->EndSession("s", SessionEnd::kByRobot, 5, std::vector{Seen(1, 1)}).ok());
    ASSERT_TRUE(store->Verify().ok());
  }
  Execute("UPDATE segment_states SET point_inliers = point_inliers + 1");
  ExpectVerifyNames("segment 1: its statistics");
  Execute("UPDATE segment_states SET point_inliers = point_inliers - 1, strategy = 2");
  ExpectVerifyNames("segment 1: its strategy");
  Execute("UPDATE segment_states SET strategy = 3, pinned = 2");
  ExpectVerifyNames("segment 1: its pin");
  Execute("UPDATE segment_states SET pinned = NULL; UPDATE sessions SET revoked = 1");
  ExpectVerifyNames("segment 1: its statistics");
  Execute("UPDATE sessions SET revoked = 0; UPDATE segment_sessions SET queries = 7");
  ExpectVerifyNames("segment 1: its statistics");
  Execute("UPDATE segment_sessions SET queries = 1; UPDATE sessions SET queries = 2");
  ExpectVerifyNames("session 's': its summary");
}

// Statistics were derived with the options of their time; another configuration is no damage.
TEST_F(SqliteStoreTest, OtherOptionsDoNotMakeOldStatisticsWrong) {
  SqliteStoreOptions options;
  options.selector.statistics.half_life_sessions = 1.0;
  options.selector.cost_1p1l = 7.0;
  options.selector.criterion = StrategyCriterion::kPaper;
  options.selector.max_iterations = 100;
  options.selector.yields.two_points = {0.5, 0.25};
  options.selector.yields.point_and_line = {0.6, 0.35};
  options.selector.yields.point_and_verticals = {0.7, 0.45};
  {
    const auto store = OpenSqliteStore(path_, options).value();
    const MapKey key = GiveMap(*store);
    for (const char* id : {"a", "b"}) {
      ASSERT_TRUE(store->StartSession(OpenSession(id, key)).ok());
      ASSERT_TRUE(store->EndSession(id, SessionEnd::kByRobot, 5, std::vector{Seen(1, 1)}).ok());
    }
  }
  const auto store = Open();
  EXPECT_TRUE(store->Verify().ok());
  EXPECT_EQ(store->GetSegment({"yard", 1}, 1)->selector, options.selector);
  EXPECT_EQ(store->GetSegment({"yard", 1}, 0)->selector, SelectorOptions{});
}

// The options in force are those of the newest session that counts, in whatever order they came.
TEST_F(SqliteStoreTest, ARevokedSessionTakesItsOptionsAlong) {
  SqliteStoreOptions other;
  other.selector.hysteresis = 0.5;
  const MapKey key = GiveMap(*Open());
  ASSERT_TRUE(Open()->StartSession(OpenSession("old", key, 1000)).ok());
  ASSERT_TRUE(Open()->StartSession(OpenSession("new", key, 2000)).ok());
  const auto configured = OpenSqliteStore(path_, other).value();
  ASSERT_TRUE(configured->EndSession("new", SessionEnd::kByRobot, 5, std::vector{Seen(1, 1)}).ok());
  const auto store = Open();
  ASSERT_TRUE(store->EndSession("old", SessionEnd::kByRobot, 9, std::vector{Seen(1, 1)}).ok());
  EXPECT_EQ(store->GetSegment(key, 1)->selector, other.selector);
  ASSERT_TRUE(store->RevokeSession("new").ok());
  EXPECT_EQ(configured->GetSegment(key, 1)->selector, SelectorOptions{});
  EXPECT_TRUE(store->Verify().ok());
}

// A store of schema version 1, made by SQL from the maps and sessions of a present one: decisions
// stood there as they were made.
TEST_F(SqliteStoreTest, AStoreOfVersion1IsBroughtUpToDate) {
  const std::string fresh_path = folder_.File("fresh.db");
  const auto fresh = OpenSqliteStore(fresh_path).value();
  const MapKey key = GiveMap(*fresh);
  for (const char* id : {"a", "b", "pin"}) {
    ASSERT_TRUE(fresh->StartSession(OpenSession(id, key)).ok());
    std::vector<Observation> seen;
    for (int i = 1; i <= 20; ++i) seen.push_back(Seen(i, 1, 100, 20, 20, 16));
    ASSERT_TRUE(fresh->EndSession(id, SessionEnd::kByRobot, 5000, seen).ok());
  }
  ASSERT_TRUE(fresh->PinStrategy(key, 2, Strategy::k2P).ok());
  {
    auto old = SqliteDatabase::Open(path_, SqliteAccess::kCreate, 1000).value();
    for (const std::string& sql : {"ATTACH '" + fresh_path + "' AS fresh",
                                   std::string(StoreMigrations()[0]), std::string(R"sql(
INSERT INTO map_versions SELECT * FROM fresh.map_versions;
INSERT INTO segments SELECT * FROM fresh.segments;
INSERT INTO segment_features SELECT * FROM fresh.segment_features;
INSERT INTO sessions SELECT * FROM fresh.sessions;
INSERT INTO session_labels SELECT * FROM fresh.session_labels;
INSERT INTO observations SELECT * FROM fresh.observations;
INSERT INTO segment_sessions SELECT map, segment, session, queries, localized, point_matches,
  point_inliers, usable_line_matches, usable_line_inliers, vertical_line_matches,
  vertical_line_inliers, median_point_matches, median_usable_line_matches,
  median_vertical_line_matches, strategy_before, strategy_after FROM fresh.segment_sessions;
INSERT INTO selector_options VALUES (7, 1.5, 0.05, 10, 10, 10, 0.3, 0.25, 1, 1, 1);
INSERT INTO decisions (map, segment, time_unix_ns, cause, options, pinned, strategy, source,
    reason, predicted_success, sessions, queries, localized, point_matches, point_inliers,
    usable_line_matches, usable_line_inliers, vertical_line_matches, vertical_line_inliers,
    typical_point_matches, typical_usable_line_matches, typical_vertical_line_matches)
  SELECT r.map, r.segment, 5000, r.session, 7, NULL, 3, 1, 'as it was', 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0 FROM fresh.segment_sessions r
  UNION ALL
  SELECT p.map, p.segment, p.time_unix_ns, 'pin', 7, p.strategy, 2, 3, 'as it was', 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0 FROM fresh.pins p;
PRAGMA application_id = 1835102316; PRAGMA user_version = 1;)sql")}) {
      const Status status = old.Execute(sql);
      ASSERT_TRUE(status.ok()) << status.ToString();
    }
  }
  const auto store = Open();
  ASSERT_TRUE(store->Verify().ok()) << store->Verify().ToString();
  SelectorOptions kept;
  kept.statistics.half_life_sessions = 1.5;
  kept.statistics.change_discount = 0.05;
  kept.hysteresis = 0.25;
  kept.cost_mixed = 1.0;
  kept.yields = NoGates();  // version 1 knew of none
  const SegmentSummary learned = store->GetSegment(key, 1).value();
  EXPECT_EQ(learned.selector, kept);
  EXPECT_EQ(store->ListRows(key, 1).value(), fresh->ListRows(key, 1).value());
  EXPECT_EQ(learned.statistics, Aggregate(store->ListRows(key, 1).value(), kept.statistics));
  EXPECT_EQ(learned.decision.strategy, Strategy::k1P1L);
  EXPECT_EQ(store->GetSegment(key, 2)->pinned, Strategy::k2P);
  EXPECT_EQ(store->ListDecisions(key, 1)->size(), 3u);
  const auto pinned = store->ListDecisions(key, 2).value();
  ASSERT_EQ(pinned.size(), 1u);
  EXPECT_EQ(pinned[0].cause, "pin");
  ASSERT_TRUE(store->RevokeSession("a").ok());
  EXPECT_EQ(store->GetSegment(key, 1)->statistics.sessions, 2);
  EXPECT_EQ(store->EndSession("a", SessionEnd::kByRobot, 1, {}).value(),
            fresh->EndSession("a", SessionEnd::kByRobot, 1, {}).value());
}

// As after an update of the selector: what is kept is derived anew once, and caches are told.
TEST_F(SqliteStoreTest, WhatAnotherProgramDerivedIsDerivedAnew) {
  {
    const auto store = Open();
    const MapKey key = GiveMap(*store);
    ASSERT_TRUE(store->StartSession(OpenSession("s", key)).ok());
    ASSERT_TRUE(store->EndSession("s", SessionEnd::kByRobot, 5, std::vector{Seen(1, 1)}).ok());
  }
  const auto before = Open();
  const std::int64_t changes = before->ChangeCounter().value();
  Execute(
      "UPDATE meta SET value = value + 1 WHERE name = 'derivation_fingerprint'; "
      "UPDATE segment_states SET reason = 'an older selector said so'");
  EXPECT_FALSE(before->Verify().ok());
  const auto store = Open();
  EXPECT_TRUE(store->Verify().ok()) << store->Verify().ToString();
  EXPECT_GT(before->ChangeCounter().value(), changes);
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
  EXPECT_EQ(Count("map_versions"), 0);
  EXPECT_EQ(GiveMap(*Open()).version, 1);
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
    if (!(*store)->AppendObservations("s", std::vector{Seen(1, 0), Seen(2, 1)}).ok()) _exit(1);
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

}  // namespace
}  // namespace maploc::testing
