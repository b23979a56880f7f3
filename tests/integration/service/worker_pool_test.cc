#include "server/service/worker_pool.h"

#include <atomic>
#include <future>

#include <gtest/gtest.h>

namespace maploc {
namespace {

using namespace std::chrono_literals;

TEST(WorkerPoolTest, RefusesWhatDoesNotFitAndRunsTheRest) {
  std::promise<void> gate;
  const std::shared_future<void> open = gate.get_future().share();
  std::atomic<int> done = 0;
  const auto job = [&] {
    open.wait();
    ++done;
  };
  {
    WorkerPool pool(2, 3, 100);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(pool.Submit(1, job), WorkerPool::Admission::kAccepted);
    EXPECT_EQ(pool.Submit(1, job), WorkerPool::Admission::kFull);
    EXPECT_FALSE(pool.WaitUntilIdle(std::chrono::steady_clock::now()));
    gate.set_value();
    EXPECT_TRUE(pool.WaitUntilIdle(std::chrono::steady_clock::now() + 60s));
    EXPECT_EQ(done, 5);
    EXPECT_EQ(pool.Submit(1, job), WorkerPool::Admission::kAccepted);
  }
  EXPECT_EQ(done, 6);  // what was accepted is finished, also at the end
}

TEST(WorkerPoolTest, RefusesWhatHoldsTooMuchMemoryWhileItWaits) {
  std::promise<void> started;
  std::promise<void> gate;
  WorkerPool pool(1, 9, 100);
  ASSERT_EQ(pool.Submit(100,
                        [&] {
                          started.set_value();
                          gate.get_future().wait();
                        }),
            WorkerPool::Admission::kAccepted);
  started.get_future().wait();
  EXPECT_EQ(pool.Submit(60, [] {}), WorkerPool::Admission::kAccepted);
  EXPECT_EQ(pool.Submit(60, [] {}), WorkerPool::Admission::kFull);
  EXPECT_EQ(pool.Submit(40, [] {}), WorkerPool::Admission::kAccepted);
  gate.set_value();
}

TEST(WorkerPoolTest, ClosedItFinishesWhatItHas) {
  std::promise<void> gate;
  std::atomic<bool> done = false;
  WorkerPool pool(1, 1, 100);
  ASSERT_EQ(pool.Submit(1,
                        [&] {
                          gate.get_future().wait();
                          done = true;
                        }),
            WorkerPool::Admission::kAccepted);
  pool.Close();
  EXPECT_EQ(pool.Submit(1, [] {}), WorkerPool::Admission::kClosed);
  gate.set_value();
  EXPECT_TRUE(pool.WaitUntilIdle(std::chrono::steady_clock::now() + 60s));
  EXPECT_TRUE(done);
}

}  // namespace
}  // namespace maploc
