// Ten times as many queries as the server can answer, for a minute. Prints what it measured,
// because client and server share this machine's cores.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "client/api/client.h"
#include "mapstore/store/sqlite_store.h"
#include "tests/support/drawn_world.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"

namespace maploc::testing {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::seconds kDeadline{2};
constexpr double kOverload = 10.0;
constexpr std::chrono::seconds kCalibration{5};
constexpr std::chrono::seconds kFlood{60};

// As many landmarks and features as real photos have, because a refusal must be cheap beside a real
// query and not beside a toy.
DrawnWorldOptions DenseStreet() {
  DrawnWorldOptions options;
  options.points_a_metre = 300;
  options.lines_a_metre = 20;
  return options;
}

Query DenseQuery(const DrawnWorld& world) {
  QueryNoise noise;
  noise.max_points = 1000;
  noise.max_lines = 100;
  Random random = TestRandom(1);
  return world.See(DrawnWorld::CameraFromMapAt(8.0, 0.1), noise, random);
}

struct Answers {
  std::vector<double> answered_ms;
  std::vector<double> refused_ms;
  std::vector<std::string> errors;  // any other
};

double Percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

class OverloadTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const DrawnWorld world(TestRandom(), DenseStreet());
    ImportWorld(world, OpenSqliteStore(folder_.File("store")).value().get());
    query_ = DenseQuery(world);
    address_ = server_.Start();
  }
  void TearDown() override { server_.Stop(); }

  // `robots` connections ask together `per_second` times a second, each at its own moments; 0: each
  // as soon as it is answered.
  Answers Ask(int robots, double per_second, std::chrono::seconds duration) {
    Answers all;
    std::mutex mutex;
    std::vector<std::thread> threads;
    const auto begin = steady_clock::now();
    for (int robot = 0; robot < robots; ++robot) {
      threads.emplace_back([&, robot] {
        const Answers own = AskAsOne(robots, robot, per_second, begin, duration);
        const std::lock_guard lock(mutex);
        all.answered_ms.insert(all.answered_ms.end(), own.answered_ms.begin(),
                               own.answered_ms.end());
        all.refused_ms.insert(all.refused_ms.end(), own.refused_ms.begin(), own.refused_ms.end());
        all.errors.insert(all.errors.end(), own.errors.begin(), own.errors.end());
      });
    }
    for (std::thread& thread : threads) thread.join();
    return all;
  }

  Answers AskAsOne(int robots, int robot, double per_second, steady_clock::time_point begin,
                   std::chrono::seconds duration) {
    ClientOptions once;
    once.call_timeout = kDeadline;
    once.max_attempts = 1;
    const Client client(address_, once);
    Answers own;
    for (int i = 0; steady_clock::now() < begin + duration; ++i) {
      if (per_second > 0) {
        std::this_thread::sleep_until(
            begin + std::chrono::duration_cast<steady_clock::duration>(
                        std::chrono::duration<double>((i * robots + robot) / per_second)));
      }
      const auto sent = steady_clock::now();
      const Result<Localization> answer = client.Localize(query_);
      const double taken_ms =
          std::chrono::duration<double, std::milli>(steady_clock::now() - sent).count();
      if (answer.ok()) {
        own.answered_ms.push_back(taken_ms);
      } else if (answer.status().reason() == "QUEUE_FULL") {
        own.refused_ms.push_back(taken_ms);
      } else {
        own.errors.push_back(answer.status().ToString());
      }
    }
    return own;
  }

  const TemporaryFolder folder_;
  ServerProcess server_{folder_};
  Query query_;
  std::string address_;
};

TEST_F(OverloadTest, IsRefusedAtOnceAndCostsNoAnswers) {
  const Answers usual = Ask(4, 0, kCalibration);
  const double most = static_cast<double>(usual.answered_ms.size()) / kCalibration.count();
  const Answers flood = Ask(64, kOverload * most, kFlood);
  const double answered = static_cast<double>(flood.answered_ms.size()) / kFlood.count();
  std::printf("%.0f answers a second at most, %.0f in the flood (%.0f refused a second)\n", most,
              answered, static_cast<double>(flood.refused_ms.size()) / kFlood.count());
  for (const auto& [name, values] :
       {std::pair("answered", &flood.answered_ms), {"refused", &flood.refused_ms}}) {
    std::printf("%s: p50 %.1f ms, p99 %.1f ms, most %.1f ms\n", name, Percentile(*values, 0.5),
                Percentile(*values, 0.99), Percentile(*values, 1.0));
  }
  EXPECT_TRUE(flood.errors.empty()) << flood.errors.size() << ", first " << flood.errors.front();
  EXPECT_LT(Percentile(flood.answered_ms, 0.99), 1000.0 * kDeadline.count());
  EXPECT_LT(Percentile(flood.refused_ms, 0.99), 10.0);
  EXPECT_GE(answered, 0.9 * most);

  const auto end = steady_clock::now();
  const Answers after = Ask(1, 0, std::chrono::seconds(2));
  EXPECT_TRUE(after.errors.empty() && after.refused_ms.empty());
  EXPECT_LT(Percentile(after.answered_ms, 0.5), 2.0 * Percentile(usual.answered_ms, 0.5));
  EXPECT_LT(steady_clock::now() - end, std::chrono::seconds(3));
}

}  // namespace
}  // namespace maploc::testing
