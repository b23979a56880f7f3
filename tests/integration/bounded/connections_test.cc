// Connections: too many of them, and sockets that listen no more.
#include <algorithm>
#include <atomic>
#include <fstream>
#include <set>
#include <vector>

#include <gmock/gmock.h>

#include "client/api/client.h"
#include "server/app/server.h"
#include "tests/integration/bounded/raw_connection.h"
#include "tests/support/server_process.h"

namespace maploc::testing {
namespace {

int PortOf(const std::string& address) {
  return address.empty() ? 0 : std::stoi(address.substr(address.rfind(':') + 1));
}

// "Max open files  SOFT  HARD  files" of a process.
std::string DescriptorLimits(pid_t pid) {
  std::ifstream limits("/proc/" + std::to_string(pid) + "/limits");
  std::string line;
  while (std::getline(limits, line) && !line.starts_with("Max open files")) continue;
  return line;
}

class FewDescriptorsTest : public ::testing::Test {
 protected:
  FewDescriptorsTest() {
    std::string command = "ulimit -S -n 80; ulimit -H -n 128; exec";
    for (const std::string& part : ServerCommand(folder_, folder_.File("store"))) {
      command += " '" + part + "'";
    }
    process_ = std::make_unique<Process>(std::vector<std::string>{"/bin/sh", "-c", command},
                                         folder_.File("stderr"));
    address_ = WaitForAddress(folder_);
  }
  std::vector<RawConnection> Connect(int count) const {
    std::vector<RawConnection> connections;
    for (int i = 0; i < count; ++i) connections.emplace_back(PortOf(address_));
    return connections;
  }

  const TemporaryFolder folder_;
  std::unique_ptr<Process> process_;
  std::string address_;
};

TEST_F(FewDescriptorsTest, TheSoftLimitIsRaisedToTheHardOne) {
  EXPECT_THAT(DescriptorLimits(process_->pid()), ::testing::ContainsRegex("128 +128 "));
}

// gRPC's own listener is lost for ever as soon as accept() fails for want of a descriptor.
TEST_F(FewDescriptorsTest, WhatIsTooMuchIsClosedAtOnceAndToldOnceAndAfterwardsAllIsWell) {
  const Client before(address_);
  ASSERT_TRUE(before.ListMaps().ok());
  {
    const std::vector<RawConnection> connections = Connect(178);
    const auto closed = [&connections] {
      return std::ranges::count_if(connections, &RawConnection::IsClosedByServer);
    };
    EXPECT_TRUE(WaitFor([&] { return closed() == 178 - 63; })) << closed();
    EXPECT_TRUE(before.ListMaps().ok());  // one of the 64
  }
  EXPECT_TRUE(WaitFor([this] { return Client(address_).ListMaps().ok(); }));
  const std::string log = folder_.Read("stderr");
  const std::size_t told = log.find("connections are refused: 64 are open");
  ASSERT_NE(told, std::string::npos) << log;
  EXPECT_EQ(log.find("connections are refused", told + 1), std::string::npos) << log;
}

// The sockets of this process that listen.
std::set<int> ListeningSockets() {
  std::set<int> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int fd = std::stoi(entry.path().filename());
    int listens = 0;
    socklen_t size = sizeof(listens);
    if (getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) == 0 && listens != 0) {
      found.insert(fd);
    }
  }
  return found;
}

TEST(ListenerTest, AServerThatCanAcceptNobodySaysSoAndEnds) {
  const TemporaryFolder folder;
  ServerOptions options;
  options.store = folder.File("store");
  options.listen = "localhost:0";
  std::atomic<bool> lost = false;
  Result<std::unique_ptr<Server>> server = Server::Start(options, [&lost] { lost = true; });
  ASSERT_TRUE(server.ok()) << server.status().ToString();
  EXPECT_FALSE(lost);
  for (const int fd : ListeningSockets()) shutdown(fd, SHUT_RDWR);
  EXPECT_TRUE(WaitFor([&lost] { return lost.load(); }));
  EXPECT_EQ((*server)->Shutdown().reason(), "LISTENER_LOST");
}

bool HasIpv6() { return !ReadFile("/proc/net/if_inet6").empty(); }

class ListenTest : public ::testing::TestWithParam<std::string> {};

// As a client writes the address; [::] and 0.0.0.0 are reached by both families.
TEST_P(ListenTest, IsReached) {
  if (GetParam() == "[::1]" && !HasIpv6()) GTEST_SKIP() << "this machine has no IPv6";
  const TemporaryFolder folder;
  ServerOptions options;
  options.store = folder.File("store");
  options.listen = GetParam() + ":0";
  options.insecure = true;
  Result<std::unique_ptr<Server>> server = Server::Start(options);
  ASSERT_TRUE(server.ok()) << server.status().ToString();
  const std::string port = ":" + std::to_string((*server)->port());
  const bool all = GetParam() == "0.0.0.0" || GetParam() == "[::]";
  for (const std::string& host : {all ? std::string("127.0.0.1") : GetParam(),
                                  std::string(all && HasIpv6() ? "[::1]" : "")}) {
    if (!host.empty()) {
      EXPECT_TRUE(Client(host + port).ListMaps().ok()) << host;
    }
  }
  options.listen = GetParam() + port;
  options.store = folder.File("second");
  const Status taken = Server::Start(options).status();
  EXPECT_EQ(taken.reason(), "CANNOT_LISTEN");
  EXPECT_NE(taken.message().find("Address already in use"), std::string::npos) << taken.message();
}

INSTANTIATE_TEST_SUITE_P(Hosts, ListenTest,
                         ::testing::Values("127.0.0.1", "[::1]", "localhost", "0.0.0.0", "[::]"));

TEST(ListenerTest, AHostThatIsNotThisMachinesIsRefused) {
  const TemporaryFolder folder;
  ServerOptions options;
  options.store = folder.File("store");
  options.insecure = true;
  const auto refusal = [&](const char* listen) {
    options.listen = listen;
    return Server::Start(options).status();
  };
  EXPECT_EQ(refusal("192.0.2.1:0").reason(), "CANNOT_LISTEN");
  EXPECT_NE(refusal("192.0.2.1:0").message().find("Cannot assign requested address"),
            std::string::npos);
  EXPECT_EQ(refusal("no-such-host.invalid:0").reason(), "CANNOT_LISTEN");
  EXPECT_NE(refusal("no-such-host.invalid:0").message().find("host is unknown"), std::string::npos);
}

}  // namespace
}  // namespace maploc::testing
