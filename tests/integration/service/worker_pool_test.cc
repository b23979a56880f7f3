#include "server/service/worker_pool.h"

#include <atomic>
#include <future>
#include <string>
#include <vector>

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
    for (int i = 0; i < 5; ++i)
      EXPECT_EQ(pool.Submit("robot", {1, job, {}}), WorkerPool::Admission::kAccepted);
    EXPECT_EQ(pool.Submit("robot", {1, job, {}}), WorkerPool::Admission::kFull);
    EXPECT_FALSE(pool.WaitUntilIdle(std::chrono::steady_clock::now()));
    gate.set_value();
    EXPECT_TRUE(pool.WaitUntilIdle(std::chrono::steady_clock::now() + 60s));
    EXPECT_EQ(done, 5);
    EXPECT_EQ(pool.Submit("robot", {1, job, {}}), WorkerPool::Admission::kAccepted);
  }
  EXPECT_EQ(done, 6);  // what was accepted is finished, also at the end
}

TEST(WorkerPoolTest, RefusesWhatHoldsTooMuchMemoryWhileItWaits) {
  std::promise<void> started;
  std::promise<void> gate;
  WorkerPool pool(1, 9, 100);
  const auto wait = [&] {
    started.set_value();
    gate.get_future().wait();
  };
  ASSERT_EQ(pool.Submit("robot", {100, wait, {}}), WorkerPool::Admission::kAccepted);
  started.get_future().wait();
  EXPECT_EQ(pool.Submit("robot", {60, [] {}, {}}), WorkerPool::Admission::kAccepted);
  EXPECT_EQ(pool.Submit("robot", {60, [] {}, {}}), WorkerPool::Admission::kFull);
  EXPECT_EQ(pool.Submit("robot", {40, [] {}, {}}), WorkerPool::Admission::kAccepted);
  gate.set_value();
}

// One greedy peer fills the queue; each polite one gets a place in it and its turn soon.
TEST(WorkerPoolTest, PeersShareItFairly) {
  std::promise<void> gate;
  std::promise<void> started;
  std::vector<std::string> ran;
  int dropped = 0;
  {
    WorkerPool pool(1, 4, 100);
    const auto submit = [&](const std::string& peer) {
      return pool.Submit(peer,
                         {1, [&ran, peer] { ran.push_back(peer); }, [&dropped] { ++dropped; }});
    };
    const auto wait = [&] {
      started.set_value();
      gate.get_future().wait();
    };
    ASSERT_EQ(pool.Submit("greedy", {1, wait, {}}), WorkerPool::Admission::kAccepted);
    started.get_future().wait();
    for (int i = 0; i < 4; ++i) EXPECT_EQ(submit("greedy"), WorkerPool::Admission::kAccepted);
    EXPECT_EQ(submit("greedy"), WorkerPool::Admission::kFull);
    EXPECT_EQ(submit("a"), WorkerPool::Admission::kAccepted);
    EXPECT_EQ(submit("b"), WorkerPool::Admission::kAccepted);
    EXPECT_EQ(dropped, 2);
    EXPECT_EQ(submit("a"), WorkerPool::Admission::kFull);  // greedy has no more than two
    gate.set_value();
  }
  EXPECT_EQ(ran, (std::vector<std::string>{"greedy", "a", "b", "greedy"}));
}

// Room is made by whole jobs, and may not suffice: then nobody has lost one.
TEST(WorkerPoolTest, WhatIsRefusedTakesNobodysPlace) {
  std::promise<void> gate;
  std::promise<void> started;
  std::vector<int> ran;
  int dropped = 0;
  {
    WorkerPool pool(1, 4, 100);
    const auto wait = [&] {
      started.set_value();
      gate.get_future().wait();
    };
    ASSERT_EQ(pool.Submit("many", {1, wait, {}}), WorkerPool::Admission::kAccepted);
    started.get_future().wait();
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(pool.Submit("many", {20, [&ran, i] { ran.push_back(i); }, [&] { ++dropped; }}),
                WorkerPool::Admission::kAccepted);
    }
    EXPECT_EQ(pool.Submit("large", {90, [] {}, {}}), WorkerPool::Admission::kFull);
    EXPECT_EQ(dropped, 0);
    gate.set_value();
  }
  EXPECT_EQ(ran, (std::vector<int>{0, 1, 2}));
}

TEST(WorkerPoolTest, ClosedItFinishesWhatItHas) {
  std::promise<void> gate;
  std::atomic<bool> done = false;
  WorkerPool pool(1, 1, 100);
  const auto wait = [&] {
    gate.get_future().wait();
    done = true;
  };
  ASSERT_EQ(pool.Submit("robot", {1, wait, {}}), WorkerPool::Admission::kAccepted);
  pool.Close();
  EXPECT_EQ(pool.Submit("robot", {1, [] {}, {}}), WorkerPool::Admission::kClosed);
  gate.set_value();
  EXPECT_TRUE(pool.WaitUntilIdle(std::chrono::steady_clock::now() + 60s));
  EXPECT_TRUE(done);
}

}  // namespace
}  // namespace maploc
