#include "client/api/proxy.h"

#include <cstdlib>

#include <gtest/gtest.h>

namespace maploc {
namespace {

class ProxyTest : public ::testing::Test {
 protected:
  ProxyTest() { Clear(); }
  ~ProxyTest() override { Clear(); }
  static void Clear() {
    for (const char* name :
         {"grpc_proxy", "https_proxy", "http_proxy", "no_grpc_proxy", "no_proxy"}) {
      unsetenv(name);
    }
  }
  static void Set(const char* name, const char* value) { setenv(name, value, 1); }
};

TEST_F(ProxyTest, ThisMachineIsKnownInEveryForm) {
  for (const char* server :
       {"localhost:50051", "127.0.0.1:50051", "127.8.0.1:1", "[::1]:50051", "0.0.0.0:1", "[::]:1",
        "ipv4:127.0.0.1:50051", "ipv6:[::1]:50051", "dns:localhost:1", "dns:///localhost:50051",
        "dns://8.8.8.8/localhost:1", "unix:/run/maploc", "unix-abstract:maploc", "localhost"}) {
    EXPECT_TRUE(IsLoopback(server)) << server;
  }
  for (const char* server : {"yard:50051", "10.0.0.1:1", "localhost.example:1", "[2001:db8::1]:1",
                             "dns:///yard:1", "", ":", "[", "unix-server:50051", "unixbox:1",
                             "127.example.org:1", "127.0.0.1.example.org:1"}) {
    EXPECT_FALSE(IsLoopback(server)) << server;
  }
}

TEST_F(ProxyTest, TellsTheProxyThatGrpcWouldTakeWithoutItsPassword) {
  EXPECT_EQ(ProxyInUse("yard:1"), "");
  Set("http_proxy", "http://third:3128");
  EXPECT_EQ(ProxyInUse("yard:1"), "http://third:3128 of http_proxy");
  Set("https_proxy", "http://me:secret@second:3128");
  EXPECT_EQ(ProxyInUse("yard:1"), "http://second:3128 of https_proxy");
  Set("grpc_proxy", "first:3128");
  EXPECT_EQ(ProxyInUse("yard:1"), "first:3128 of grpc_proxy");
  EXPECT_EQ(ProxyInUse("127.0.0.1:1"), "");
}

TEST_F(ProxyTest, HostsThatGoWithoutHaveNone) {
  Set("http_proxy", "http://proxy:3128");
  Set("no_proxy", "other, .example");
  EXPECT_EQ(ProxyInUse("yard.example:1"), "");
  EXPECT_NE(ProxyInUse("yard.example.org:1"), "");
  Set("no_grpc_proxy", "org");  // beats no_proxy
  EXPECT_EQ(ProxyInUse("yard.example.org:1"), "");
  EXPECT_NE(ProxyInUse("yard.example:1"), "");
}

}  // namespace
}  // namespace maploc
