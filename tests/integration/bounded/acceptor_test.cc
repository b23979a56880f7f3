// Connections that come without end: they must hold up neither the stop nor the look at uploads.
#include "server/app/acceptor.h"

#include <chrono>
#include <future>
#include <optional>

#include <gtest/gtest.h>

#include "tests/integration/bounded/raw_connection.h"

namespace maploc::testing {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

TEST(AcceptorTest, StopsWhileConnectionsKeepComing) {
  Result<ListeningSockets> sockets = ListenOn("127.0.0.1:0");
  ASSERT_TRUE(sockets.ok()) << sockets.status().ToString();
  const int port = sockets->port;
  Connections connections(100);
  const Clock::time_point until = Clock::now() + 20s;
  std::promise<void> flooded;
  int accepted = 0;
  // The next one waits before the last one is done with, so that the queue is never empty.
  std::optional<RawConnection> next;
  const auto take = [&](int fd) {
    if (Clock::now() < until) next.emplace(port);
    close(fd);
    if (++accepted == 100) flooded.set_value();
  };
  auto acceptor =
      std::make_unique<Acceptor>(*std::move(sockets), &connections, AcceptorOptions{take, [] {}});
  const RawConnection first(port);
  flooded.get_future().wait();
  acceptor.reset();
  EXPECT_LT(Clock::now(), until);
}

}  // namespace
}  // namespace maploc::testing
