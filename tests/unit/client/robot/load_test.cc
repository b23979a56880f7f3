#include "client/robot/load.h"

#include <fstream>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

namespace maploc {
namespace {

// The address space that this process may still take. A thread's stack alone takes 8 MiB of it.
class AddressSpaceLeft {
 public:
  explicit AddressSpaceLeft(rlim_t bytes) {
    std::int64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    getrlimit(RLIMIT_AS, &before_);
    const auto used = static_cast<rlim_t>(pages * sysconf(_SC_PAGESIZE));
    const rlimit limit{used + bytes, before_.rlim_max};
    setrlimit(RLIMIT_AS, &limit);
  }
  ~AddressSpaceLeft() { setrlimit(RLIMIT_AS, &before_); }
  AddressSpaceLeft(const AddressSpaceLeft&) = delete;
  AddressSpaceLeft& operator=(const AddressSpaceLeft&) = delete;

 private:
  rlimit before_{};
};

TEST(RunLoadTest, SendsNothingWhereTheSystemHasTooFewThreads) {
  const Client warm_up("127.0.0.1:1");  // gRPC's own threads
  LoadOptions options;
  options.robots = 500;
  options.sessions = false;
  const std::vector<Query> queries(1);
  const AddressSpaceLeft left(rlim_t{512} << 20);
  const Result<LoadReport> report = RunLoad("127.0.0.1:1", "yard", queries, options);
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.status().reason(), "TOO_MANY_THREADS") << report.status().ToString();
}

}  // namespace
}  // namespace maploc
