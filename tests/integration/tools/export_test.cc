// A map from one store to another through a file.
#include <sys/resource.h>

#include "mapstore/store/schema.h"
#include "mapstore/store/sqlite_database.h"
#include "tests/integration/tools/maploc_map_fixture.h"
#include "tests/support/files.h"

namespace maploc::testing {
namespace {

using nlohmann::json;

TEST_F(MaplocMap, AnExportedMapIsTheSameInAnotherStore) {
  const std::string file = folder_.File("yard.maploc");
  ASSERT_EQ(Map("export --store $STORE --map yard --to " + file).exit_code, 0);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_EQ(entry.path().string().find("partial"), std::string::npos) << entry.path();
  }
  const std::string other = folder_.File("other.db");
  ASSERT_EQ(Map("import --store " + other + " --from " + file).exit_code, 0);
  EXPECT_EQ(Map("verify --store " + other).exit_code, 0);
  const json here = Json("list --store $STORE");
  const json there = Json("list --store " + other);
  ASSERT_EQ(there.size(), 1u);
  for (const char* key : {"map", "metric", "segments", "points", "lines", "usable_lines"}) {
    EXPECT_EQ(there[0].at(key), here[0].at(key)) << key;
  }
  EXPECT_EQ(there[0].at("version"), 1);
  const MapKey from = OpenSqliteStore(store_).value()->GetMap("yard")->info.key;
  const auto segment = OpenSqliteStore(store_).value()->LoadSegment(from, 1).value();
  const auto copy = OpenSqliteStore(other).value()->LoadSegment({"yard", 1}, 1).value();
  EXPECT_EQ(copy->points.positions_in_map, segment->points.positions_in_map);
  EXPECT_EQ(copy->points.descriptors.bytes, segment->points.descriptors.bytes);
  EXPECT_EQ(copy->lines.ids, segment->lines.ids);
}

TEST_F(MaplocMap, AnImportedMapIsANewVersionAndNothingIsReplaced) {
  const std::string file = folder_.File("yard.maploc");
  ASSERT_EQ(Map("export --store $STORE --map yard --to " + file).exit_code, 0);
  ExpectFails("export --store $STORE --map yard --to " + file, "exists already");
  const std::int64_t before = OpenSqliteStore(store_).value()->GetMap("yard")->info.key.version;
  ASSERT_EQ(Map("import --store $STORE --from " + file).exit_code, 0);
  EXPECT_EQ(OpenSqliteStore(store_).value()->GetMap("yard")->info.key.version, before + 1);
  EXPECT_EQ(OpenSqliteStore(store_).value()->GetSession("s")->map.version, before);
}

// The file must not get the number of the output that the caller has closed.
TEST_F(MaplocMap, AClosedOutputDoesNotGetIntoTheFile) {
  const std::string file = folder_.File("yard.maploc");
  const std::string command = std::string(MAPLOC_BIN_DIR) + "/maploc-map export --store " + store_ +
                              " --map yard --to " + file + " <&- >&- 2>&-";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(Map("import --store " + folder_.File("other.db") + " --from " + file).exit_code, 0);
}

// As `ulimit -f` sets it; a file system's largest file is the same to SQLite.
TEST_F(MaplocMap, AtALimitOnFilesTheCauseAndTheCureAreNamed) {
  const std::string file = folder_.File("yard.maploc");
  ASSERT_EQ(Map("export --store $STORE --map yard --to " + file).exit_code, 0);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{40 * 1024, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const Output import = Map("import --store $STORE --from " + file);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  ExpectFailed(import, "ulimit -f");
  EXPECT_THAT(import.error, ::testing::HasSubstr("raise the limit"));
  EXPECT_EQ(Map("verify --store $STORE").exit_code, 0);
}

TEST_F(MaplocMap, AnImportLeavesItsFileAsItWas) {
  const std::string file = folder_.File("yard.maploc");
  ASSERT_EQ(Map("export --store $STORE --map yard --to " + file).exit_code, 0);
  const std::string before = ReadFile(file);
  const std::string target = folder_.File("target.db");
  EXPECT_EQ(Map("import --store " + target + " --from " + file).exit_code, 0);
  EXPECT_EQ(ReadFile(file), before);
  {
    auto database = SqliteDatabase::Open(file, SqliteAccess::kWrite, 1000);
    const std::string older = std::to_string(StoreSchemaVersion() - 1);
    ASSERT_TRUE(database->Execute("PRAGMA user_version = " + older).ok());
  }
  const std::string old = ReadFile(file);
  ExpectFails("import --store " + target + " --from " + file, "another version of maploc");
  EXPECT_EQ(ReadFile(file), old);
  EXPECT_FALSE(std::filesystem::exists(file + "-wal"));
  ExpectFails("import --store $STORE --from " + store_, "is the store itself");
}

TEST_F(MaplocMap, OfSeveralMapsOneMustBeNamed) {
  GiveMap(*OpenSqliteStore(store_).value(), "garden");
  const std::string target = folder_.File("target.db");
  ExpectFails("import --store " + target + " --from " + store_, "name one of them with --map");
  EXPECT_EQ(Map("import --store " + target + " --map garden --from " + store_).exit_code, 0);
  EXPECT_EQ(Json("list --store " + target)[0].at("map"), "garden");
}

}  // namespace
}  // namespace maploc::testing
