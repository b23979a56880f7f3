// Connections whose peer is gone, or says nothing. Takes a minute: the server must wait for them.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "client/api/client.h"
#include "tests/integration/bounded/raw_connection.h"
#include "tests/support/server_process.h"

namespace maploc::testing {
namespace {

constexpr std::chrono::seconds kGoneWithin{120};
constexpr int kConnections = 2000;

// This process has a descriptor for each of them.
void RaiseDescriptorLimit() {
  rlimit limit;
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &limit), 0);
  ASSERT_GE(limit.rlim_max, kConnections + 100u);
  limit.rlim_cur = limit.rlim_max;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &limit), 0);
}

TEST(VanishedTest, SilentConnectionsAreEndedAndAnIdleRobotSeesNoError) {
  ASSERT_NO_FATAL_FAILURE(RaiseDescriptorLimit());
  const TemporaryFolder folder;
  ServerProcess server(folder);
  const std::string address = server.Start();
  const int port = std::stoi(address.substr(address.rfind(':') + 1));
  const Client idle(address);
  ASSERT_TRUE(idle.ListMaps().ok());
  std::vector<RawConnection> silent;
  for (int i = 0; i < kConnections; ++i) {
    silent.emplace_back(port);
    // Every other one begins as HTTP/2 does, and answers no ping.
    if (i % 2 == 1) {
      silent.back().Send("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + std::string("\0\0\0\4\0\0\0\0\0", 9));
    }
  }
  EXPECT_TRUE(
      WaitFor([&silent] { return std::ranges::all_of(silent, &RawConnection::IsClosedByServer); },
              kGoneWithin));
  EXPECT_TRUE(idle.ListMaps().ok());
  server.Stop();
}

}  // namespace
}  // namespace maploc::testing
