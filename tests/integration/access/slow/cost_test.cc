// What TLS and a token cost a call, beside plain text in the same run.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <vector>

#include "tests/integration/access/access_fixture.h"

namespace maploc::testing {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kCalls = 2000;
constexpr double kMostCost = 1.5;

class CostTest : public AccessTest {
 protected:
  // Calls of both in turn, so that what else the machine does hits both.
  template <class Call>
  double Ratio(const char* name, const Client& plain, const Client& secure, const Call& call) {
    std::vector<double> plain_us;
    std::vector<double> secure_us;
    for (int i = 0; i < kCalls; ++i) {
      plain_us.push_back(Microseconds(plain, call));
      secure_us.push_back(Microseconds(secure, call));
    }
    const double ratio = Median(secure_us) / Median(plain_us);
    std::cout << name << ": p50 plain " << Median(plain_us) << " us, TLS and token "
              << Median(secure_us) << " us, ratio " << ratio << "\n";
    return ratio;
  }

 private:
  template <class Call>
  static double Microseconds(const Client& client, const Call& call) {
    const auto begin = Clock::now();
    EXPECT_TRUE(call(client));
    return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
  }
  static double Median(std::vector<double> values) {
    std::ranges::nth_element(values, values.begin() + values.size() / 2);
    return values[values.size() / 2];
  }
};

TEST_F(CostTest, ACallWithTlsAndATokenCostsAtMostHalfMore) {
  options_.store = folder_.File("store");
  StartServer();
  const std::unique_ptr<Server> plain_server = std::move(server_);
  const Client plain("127.0.0.1:" + std::to_string(plain_server->port()));
  std::filesystem::copy_file(folder_.File("store"), folder_.File("second"));
  options_.store = folder_.File("second");
  GiveServer(authority_.Issue("IP:127.0.0.1"));
  ClientCredentials credentials = Believing(authority_);
  credentials.token = NewToken(Role::kRobot, "rover");
  StartServer();
  const Client secure = Connect(credentials);

  // Nothing to match, and as many bytes as a usual query has.
  Query empty = QueryIn("");
  empty.views[0].points = {};
  empty.views[0].lines = {};
  EXPECT_LE(Ratio("Localize, nothing to match", plain, secure,
                  [&](const Client& client) { return client.Localize(empty).ok(); }),
            kMostCost);
  EXPECT_LE(Ratio("Localize, the street's query", plain, secure,
                  [&](const Client& client) { return client.Localize(QueryIn("")).ok(); }),
            kMostCost);
}

}  // namespace
}  // namespace maploc::testing
