#include "server/sessions/segment_cache.h"

#include <algorithm>
#include <atomic>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "mapstore/store/in_memory_store.h"
#include "tests/support/forwarding_store.h"
#include "tests/support/seed.h"
#include "tests/support/stored_world.h"
#include "tests/support/wait_for.h"

namespace maploc {
namespace {

using namespace std::chrono_literals;
using Shared = SegmentCache::SharedSegment;

// Copies each segment, as a store on disk does; counts loads, and holds or spoils some.
class WatchedStore final : public testing::ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<Shared> LoadSegment(const MapKey& key, SegmentId id) const override {
    ++loads;
    if (id < held_below) holds.wait(true);
    if (id == damaged) return Status(StatusCode::kDataLoss, "DAMAGED_SEGMENT", "points: damaged");
    MAPLOC_ASSIGN_OR_RETURN(const Shared segment, store_->LoadSegment(key, id));
    return std::make_shared<const Segment>(*segment);
  }
  void Release() {
    holds = false;
    holds.notify_all();
  }

  mutable std::atomic<int> loads = 0;
  std::atomic<SegmentId> held_below = 0;
  std::atomic<bool> holds = true;
  std::atomic<SegmentId> damaged = -1;
};

class SegmentCacheTest : public ::testing::Test {
 protected:
  static constexpr int kSegments = 6;

  SegmentCacheTest() { testing::ImportWorld(world_, memory_.get()); }
  ~SegmentCacheTest() override { store_.Release(); }

  static testing::DrawnWorldOptions Street() {
    testing::DrawnWorldOptions street;
    street.segments = kSegments;
    street.points_a_metre = 2;
    return street;
  }
  // Room for these segments, to the byte.
  std::int64_t BytesOfThese(const std::set<SegmentId>& ids) {
    std::int64_t bytes = 0;
    for (const SegmentId id : ids) bytes += BytesOf(*store_.LoadSegment(key(), id).value());
    store_.loads = 0;
    return bytes;
  }
  MapInfo version() { return memory_->GetMap("street")->info; }
  MapKey key() { return version().key; }
  int LoadsOf(const SegmentSource& source, SegmentId id) {
    const int before = store_.loads;
    EXPECT_EQ(source.Get(id, {})->get()->id, id);
    return store_.loads - before;
  }

  const testing::DrawnWorld world_{testing::TestRandom(), Street()};
  const std::unique_ptr<MapStore> memory_ = NewInMemoryStore();
  WatchedStore store_{memory_.get()};
};

TEST_F(SegmentCacheTest, TheLeastRecentlyUsedGoFirstAndTheBudgetCountsBytes) {
  SegmentCache cache(&store_, std::max(BytesOfThese({1, 2, 3}), BytesOfThese({1, 3, 4})));
  const auto source = cache.Open(version());
  for (const SegmentId id : {1, 2, 3}) EXPECT_EQ(LoadsOf(*source, id), 1);
  for (const SegmentId id : {1, 2, 3}) EXPECT_EQ(LoadsOf(*source, id), 0);
  EXPECT_EQ(LoadsOf(*source, 1), 0);
  EXPECT_EQ(LoadsOf(*source, 4), 1);  // 2 was used before 3 and 1
  EXPECT_EQ(LoadsOf(*source, 1), 0);
  EXPECT_EQ(LoadsOf(*source, 3), 0);
  EXPECT_EQ(LoadsOf(*source, 2), 1);
}

TEST_F(SegmentCacheTest, ItsStateTellsWhatWasUsedLoadedAndEvicted) {
  const std::int64_t budget = BytesOfThese({1, 2, 3}) - 1;
  SegmentCache cache(&store_, budget);
  const auto source = cache.Open(version());
  for (const SegmentId id : {1, 2, 3}) LoadsOf(*source, id);  // 1 leaves
  EXPECT_EQ(LoadsOf(*source, 3), 0);
  const SegmentCacheState state = cache.state();
  EXPECT_EQ(state.hits, 1u);
  EXPECT_EQ(state.loads, 3u);
  EXPECT_EQ(state.evictions, 1u);
  EXPECT_EQ(state.budget_bytes, budget);
  EXPECT_EQ(state.bytes, BytesOfThese({2, 3}));
}

TEST_F(SegmentCacheTest, OneByteLessIsOneSegmentLess) {
  SegmentCache cache(&store_, BytesOfThese({1, 2, 3}) - 1);
  const auto source = cache.Open(version());
  for (const SegmentId id : {1, 2, 3}) EXPECT_EQ(LoadsOf(*source, id), 1);
  EXPECT_EQ(LoadsOf(*source, 3), 0);
  EXPECT_EQ(LoadsOf(*source, 2), 0);
  EXPECT_EQ(LoadsOf(*source, 1), 1);
}

TEST_F(SegmentCacheTest, WhatIsInUseStaysAndIsSharedHoweverSmallTheBudget) {
  SegmentCache cache(&store_, 1);
  const auto source = cache.Open(version());
  Shared used = source->Get(1, {}).value();
  EXPECT_EQ(LoadsOf(*source, 2), 1);
  EXPECT_EQ(source->Get(1, {}).value(), used);
  EXPECT_EQ(LoadsOf(*source, 2), 1);  // nobody had it
  const std::weak_ptr<const Segment> gone = used;
  used.reset();
  EXPECT_EQ(LoadsOf(*source, 3), 1);
  EXPECT_TRUE(gone.expired());
}

TEST_F(SegmentCacheTest, SegmentsGoWithTheirSource) {
  SegmentCache cache(&store_, 1'000'000'000);
  auto source = cache.Open(version());
  const std::weak_ptr<const Segment> segment = source->Get(1, {}).value();
  EXPECT_FALSE(segment.expired());
  source.reset();
  EXPECT_TRUE(segment.expired());
}

TEST_F(SegmentCacheTest, QueriesThatNeedOneSegmentWaitForOneLoadAndOthersDoNotWait) {
  SegmentCache cache(&store_, 1'000'000'000);
  const auto source = cache.Open(version());
  store_.held_below = 2;
  std::vector<Shared> got(4);
  std::vector<std::thread> queries;
  for (Shared& segment : got) {
    queries.emplace_back([&] { segment = source->Get(1, {}).value(); });
  }
  EXPECT_TRUE(testing::WaitFor([&] { return store_.loads == 1; }));
  EXPECT_EQ(LoadsOf(*source, 2), 1);
  store_.Release();
  for (std::thread& query : queries) query.join();
  EXPECT_EQ(store_.loads, 2);
  for (const Shared& segment : got) EXPECT_EQ(segment, got[0]);
}

TEST_F(SegmentCacheTest, WhoeverWaitsGivesUpAtTheDeadlineAndTheLoadIsKept) {
  SegmentCache cache(&store_, 1'000'000'000);
  const auto source = cache.Open(version());
  store_.held_below = 2;
  const Interrupt soon{std::chrono::steady_clock::now() + 20ms, nullptr};
  EXPECT_EQ(source->Get(1, soon).status().code(), StatusCode::kDeadlineExceeded);
  const std::atomic<bool> cancelled = true;
  EXPECT_EQ(source->Get(1, {kNoDeadline, &cancelled}).status().code(), StatusCode::kCancelled);
  store_.Release();
  EXPECT_EQ(source->Get(1, {})->get()->id, 1);
  EXPECT_EQ(store_.loads, 1);
  EXPECT_TRUE(source->Get(1, soon).ok());  // in memory: nothing to wait for
}

TEST_F(SegmentCacheTest, WhatNobodyWaitsForAnyMoreIsNotLoaded) {
  SegmentCache cache(&store_, 1'000'000'000);
  const auto source = cache.Open(version());
  store_.held_below = kLoadingThreads;
  std::vector<std::thread> queries;
  for (SegmentId id = 0; id < kLoadingThreads; ++id) {
    queries.emplace_back([&, id] { EXPECT_TRUE(source->Get(id, {}).ok()); });
  }
  EXPECT_TRUE(testing::WaitFor([&] { return store_.loads == kLoadingThreads; }));
  const std::atomic<bool> cancelled = true;
  EXPECT_EQ(source->Get(4, {kNoDeadline, &cancelled}).status().code(), StatusCode::kCancelled);
  store_.Release();
  for (std::thread& query : queries) query.join();
  EXPECT_TRUE(source->Get(5, {}).ok());  // queued after it
  EXPECT_EQ(store_.loads, kLoadingThreads + 1);
}

TEST_F(SegmentCacheTest, ADamagedSegmentIsAnErrorOfItsOwnQueriesAndLoadedAgainOnceItIsWhole) {
  SegmentCache cache(&store_, 1'000'000'000);
  const auto source = cache.Open(version());
  store_.damaged = 5;
  EXPECT_EQ(source->Get(5, {}).status().code(), StatusCode::kDataLoss);
  EXPECT_EQ(LoadsOf(*source, 4), 1);
  EXPECT_EQ(source->Get(5, {}).status().code(), StatusCode::kDataLoss);
  store_.damaged = -1;
  EXPECT_EQ(LoadsOf(*source, 5), 1);
}

// Its number may go to another import, whose segments are not the query's.
TEST_F(SegmentCacheTest, AVersionThatIsGoneGivesNoSegmentsOfAnother) {
  SegmentCache cache(&store_, 1'000'000'000);
  MapInfo older = version();
  older.created_unix_ns -= 1;
  EXPECT_EQ(cache.Open(older)->Get(1, {}).status().reason(), kMapMoves);
  MapInfo gone = version();
  gone.key.version += 1;
  EXPECT_EQ(cache.Open(gone)->Get(1, {}).status().reason(), kMapMoves);
}

}  // namespace
}  // namespace maploc
