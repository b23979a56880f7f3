// A finished file gets its name, also where the file system knows no links; nothing is replaced.
#include <cerrno>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "mapstore/store/sqlite_backup.h"
#include "mapstore/store/sqlite_store.h"
#include "tests/support/files.h"

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

// Linux refuses a link to another user's file with EPERM (fs.protected_hardlinks), as vfat does
// any.
TEST_F(SqlitePublishTest, AFileThatCannotBeLinkedIsPublishedAllTheSame) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a file to another user";
  constexpr uid_t kNobody = 65534;
  chmod(folder_.path().c_str(), 0777);
  chmod(partial_.c_str(), 0600);
  ASSERT_EQ(seteuid(kNobody), 0);
  const Status published = PublishStoreFile(partial_, to_);
  ASSERT_EQ(seteuid(0), 0);
  EXPECT_TRUE(published.ok()) << published.ToString();
  EXPECT_EQ(folder_.Read("store"), "new");
  folder_.Write("partial", "newer");
  ASSERT_EQ(seteuid(kNobody), 0);
  const Status again = PublishStoreFile(partial_, to_);
  ASSERT_EQ(seteuid(0), 0);
  EXPECT_EQ(again.reason(), "FILE_EXISTS");
  EXPECT_EQ(folder_.Read("store"), "new");
}

}  // namespace
}  // namespace maploc::testing
