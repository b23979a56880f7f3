// A finished file gets its name, also where the file system knows no links; nothing is replaced.
#include <cerrno>

#include <gtest/gtest.h>

#include "mapstore/store/sqlite_backup.h"
#include "mapstore/store/sqlite_store.h"
#include "tests/support/files.h"
#include "tests/unit/mapstore/store/no_links.h"

namespace maploc::testing {
namespace {

class SqlitePublishTest : public ::testing::Test {
 protected:
  SqlitePublishTest() { folder_.Write("partial", "new"); }

  TemporaryFolder folder_;
  std::string partial_ = folder_.File("partial");
  std::string to_ = folder_.File("store");
};

TEST_F(SqlitePublishTest, RenamesToANewNameOnly) {
  for (const auto rename : {RenameToNewName, RenameOverOwnFile}) {
    folder_.Write("partial", "new");
    folder_.Write("store", "old");
    EXPECT_FALSE(rename(partial_, to_));
    EXPECT_EQ(errno, EEXIST);
    EXPECT_EQ(folder_.Read("store"), "old");
    EXPECT_EQ(folder_.Read("partial"), "new");
    std::filesystem::remove(to_);
    EXPECT_TRUE(rename(partial_, to_));
    EXPECT_EQ(folder_.Read("store"), "new");
    EXPECT_FALSE(std::filesystem::exists(partial_));
    std::filesystem::remove(to_);
  }
}

TEST_F(SqlitePublishTest, AFailureLeavesNoFileBehind) {
  for (const auto rename : {RenameToNewName, RenameOverOwnFile}) {
    EXPECT_FALSE(rename(folder_.File("none"), to_));
    EXPECT_EQ(errno, ENOENT);
    EXPECT_FALSE(std::filesystem::exists(to_));
  }
}

TEST_F(SqlitePublishTest, WithoutLinksAFileIsPublishedAllTheSame) {
  const NoLinks vfat;
  const Status published = PublishStoreFile(partial_, to_);
  EXPECT_TRUE(published.ok()) << published.ToString();
  EXPECT_EQ(folder_.Read("store"), "new");
  folder_.Write("partial", "newer");
  EXPECT_EQ(PublishStoreFile(partial_, to_).reason(), "FILE_EXISTS");
  EXPECT_EQ(folder_.Read("store"), "new");
}

}  // namespace
}  // namespace maploc::testing
