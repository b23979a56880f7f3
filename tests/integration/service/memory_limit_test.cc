// What a machine or its control groups allow.
#include "server/app/memory_limit.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/files.h"

namespace maploc::testing {
namespace {

constexpr std::int64_t kMiB = 1 << 20;  // less than any machine has

class MemoryLimitTest : public ::testing::Test {
 protected:
  void Give(const std::string& file, const std::string& text) {
    const std::filesystem::path path = folder_.File(file);
    std::filesystem::create_directories(path.parent_path());
    WriteFile(path.string(), text);
  }
  std::int64_t Limit() const { return MemoryLimit(folder_.File("")); }

  const TemporaryFolder folder_;
};

TEST_F(MemoryLimitTest, WithoutGroupsItIsTheMachines) {
  const std::int64_t machine = Limit();
  EXPECT_GT(machine, 64 * kMiB);
  Give("sys/fs/cgroup/memory.max", "max\n");
  Give("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(Limit(), machine);
}

TEST_F(MemoryLimitTest, TheTightestGroupCounts) {
  Give("proc/self/cgroup", "0::/robots.slice/maploc.service\n");
  Give("sys/fs/cgroup/robots.slice/maploc.service/memory.max", "50331648\n");
  EXPECT_EQ(Limit(), 48 * kMiB);
  Give("sys/fs/cgroup/robots.slice/memory.max", "33554432\n");
  EXPECT_EQ(Limit(), 32 * kMiB);
  Give("sys/fs/cgroup/memory.max", "16777216\n");  // a container's own root
  EXPECT_EQ(Limit(), 16 * kMiB);
}

TEST_F(MemoryLimitTest, OlderControlGroupsCountToo) {
  Give("proc/self/cgroup", "4:memory:/docker/0123\n");
  Give("sys/fs/cgroup/memory/memory.limit_in_bytes", "50331648\n");
  EXPECT_EQ(Limit(), 48 * kMiB);
}

}  // namespace
}  // namespace maploc::testing
