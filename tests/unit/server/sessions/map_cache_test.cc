#include "server/sessions/map_cache.h"

#include <atomic>
#include <map>
#include <mutex>

#include <gtest/gtest.h>

#include "mapstore/store/in_memory_store.h"
#include "tests/support/forwarding_store.h"
#include "tests/support/seed.h"
#include "tests/support/stored_world.h"
#include "tests/support/wait_for.h"

namespace maploc {
namespace {

using namespace std::chrono_literals;

class MapCacheTest : public ::testing::Test {
 protected:
  MapCacheTest() : world_(testing::TestRandom(), Tiny()) {
    key_ = testing::ImportWorld(world_, store_.get());
  }

  static testing::DrawnWorldOptions Tiny() {
    testing::DrawnWorldOptions tiny;
    tiny.points_a_metre = 1;
    return tiny;
  }
  static Strategy StrategyOf(const MapCache::Snapshot& map, SegmentId segment) {
    return map->decisions[segment].strategy;
  }

  const testing::DrawnWorld world_;
  const std::unique_ptr<MapStore> store_ = NewInMemoryStore();
  MapKey key_;
};

TEST_F(MapCacheTest, LoadsOnceAndShares) {
  MapCache cache(store_.get());
  const MapCache::Snapshot map = cache.Enabled("street").value();
  EXPECT_EQ(map->info.key, key_);
  ASSERT_EQ(map->decisions.size(), world_.segments().size());
  EXPECT_EQ(map->Load(1, {})->segment->points.ids, world_.segments()[1]->points.ids);
  EXPECT_EQ(cache.Enabled("street").value(), map);
  EXPECT_EQ(cache.Get(key_).value(), map);
}

TEST_F(MapCacheTest, UnknownMapsAreNotFound) {
  MapCache cache(store_.get());
  EXPECT_EQ(cache.Enabled("garden").status().reason(), "MAP_NOT_FOUND");
  EXPECT_EQ(cache.Get({"street", 9}).status().reason(), "MAP_NOT_FOUND");
}

TEST_F(MapCacheTest, AnOldVersionOfASessionDoesNotHideTheNewest) {
  const MapKey newer = testing::ImportWorld(world_, store_.get());
  MapCache cache(store_.get());
  ASSERT_EQ(cache.Get(key_).value()->info.key, key_);  // a session that outlived a restart
  EXPECT_EQ(cache.Enabled("street").value()->info.key, newer);
}

TEST_F(MapCacheTest, AMapThatWasImportedJustNowIsFound) {
  MapCache cache(store_.get());
  ASSERT_TRUE(cache.Enabled("street").ok());
  MapInfo info = world_.info();
  info.key.name = "garden";
  auto writer = store_->BeginImport(info).value();
  ASSERT_TRUE(writer->AddSegment(*world_.segments()[0]).ok());
  ASSERT_TRUE(writer->Commit().ok());
  EXPECT_EQ(cache.Enabled("garden")->get()->decisions.size(), 1u);
}

// Publishes a new version at a chosen moment: while the one before is being loaded.
class StoreWithALateImport final : public testing::ForwardingStore {
 public:
  StoreWithALateImport(MapStore* store, const testing::DrawnWorld& world)
      : ForwardingStore(store), world_(world) {}
  Result<std::vector<SegmentPlace>> LoadPlaces(const MapKey& key) const override {
    if (!imported_.exchange(true)) testing::ImportWorld(world_, store_);
    return store_->LoadPlaces(key);
  }

 private:
  const testing::DrawnWorld& world_;
  mutable std::atomic<bool> imported_ = false;
};

TEST_F(MapCacheTest, AVersionThatIsPublishedWhileAnOlderOneLoadsIsServed) {
  const StoreWithALateImport store(store_.get(), world_);
  MapCacheOptions options;
  options.poll_interval = 1h;  // the thread looks before the import, and then no more
  MapCache cache(&store, options);
  EXPECT_EQ(cache.Enabled("street").value()->info.key.version, key_.version + 1);
  EXPECT_EQ(cache.Enabled("street").value()->info.key.version, key_.version + 1);
}

TEST_F(MapCacheTest, RefreshSeesAStrategyAndSharesTheSegments) {
  MapCacheOptions options;
  options.poll_interval = 1h;
  MapCache cache(store_.get(), options);
  const MapCache::Snapshot before = cache.Enabled("street").value();
  ASSERT_TRUE(store_->PinStrategy(key_, 1, Strategy::k2P).ok());
  EXPECT_EQ(StrategyOf(cache.Enabled("street").value(), 1), Strategy::kMixed);

  ASSERT_TRUE(cache.Refresh().ok());

  const MapCache::Snapshot after = cache.Enabled("street").value();
  EXPECT_EQ(StrategyOf(after, 1), Strategy::k2P);
  EXPECT_EQ(after->decisions[1].source, StrategySource::kPinned);
  EXPECT_EQ(after->Load(1, {})->segment, before->Load(1, {})->segment);
  EXPECT_EQ(after->places, before->places);
  EXPECT_EQ(StrategyOf(before, 1), Strategy::kMixed);  // a running query keeps what it has
}

TEST_F(MapCacheTest, TheThreadSeesPinsAndNewVersions) {
  MapCacheOptions options;
  options.poll_interval = 5ms;
  MapCache cache(store_.get(), options);
  const MapCache::Snapshot old = cache.Enabled("street").value();
  ASSERT_TRUE(store_->PinStrategy(key_, 0, Strategy::k1P1L).ok());
  EXPECT_TRUE(testing::WaitFor(
      [&] { return StrategyOf(cache.Enabled("street").value(), 0) == Strategy::k1P1L; }));

  const MapKey newer = testing::ImportWorld(world_, store_.get());
  EXPECT_TRUE(testing::WaitFor([&] { return cache.Enabled("street").value()->info.key == newer; }));
  // A session that began on the old version stays there.
  EXPECT_EQ(cache.Get(key_).value()->info.key, key_);
}

// A store in whose place another one can be put, or none that answers.
class ChangingStore final : public testing::ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<MapSummary> GetMap(const MapKey& key) const override { return Now().GetMap(key); }
  Result<MapSummary> GetMap(const std::string& name) const override { return Now().GetMap(name); }
  Result<std::vector<SegmentSummary>> ListSegments(const MapKey& key) const override {
    return Now().ListSegments(key);
  }
  Result<std::vector<SegmentSummary>> ListChangedSegments(const MapKey& key,
                                                          std::int64_t since) const override {
    return Now().ListChangedSegments(key, since);
  }
  Result<std::shared_ptr<const Segment>> LoadSegment(const MapKey& key,
                                                     SegmentId id) const override {
    return Now().LoadSegment(key, id);
  }
  Result<std::vector<SegmentPlace>> LoadPlaces(const MapKey& key) const override {
    if (damaged) return Status(StatusCode::kDataLoss, "DAMAGED_PLACE", "a place is damaged");
    return Now().LoadPlaces(key);
  }
  Result<std::vector<MapSummary>> ListMaps() const override { return Now().ListMaps(); }
  Result<std::int64_t> ChangeCounter() const override {
    if (throws) throw std::bad_alloc();
    return counter.load();
  }
  void PutInPlace(MapStore* other) {
    now_ = other;
    ++counter;
  }
  std::atomic<std::int64_t> counter = 0;
  std::atomic<bool> throws = false;
  std::atomic<bool> damaged = false;

 private:
  MapStore& Now() const { return *now_.load(); }

  std::atomic<MapStore*> now_ = store_;
};

// The abort of old: fewer segments, or more, under the same name and version.
TEST_F(MapCacheTest, AnotherContentUnderTheSameVersionIsNeitherServedNorMixed) {
  const std::unique_ptr<MapStore> others = NewInMemoryStore();
  MapInfo info = world_.info();
  info.created_unix_ns += 1;
  auto writer = others->BeginImport(info).value();
  ASSERT_TRUE(writer->AddSegment(*world_.segments()[0]).ok());
  ASSERT_TRUE(writer->Commit().ok());
  ChangingStore store(store_.get());
  MapCacheOptions options;
  options.poll_interval = 1h;
  MapCache cache(&store, options);
  ASSERT_GT(cache.Enabled("street").value()->decisions.size(), 1u);
  store.PutInPlace(others.get());
  ASSERT_TRUE(cache.Refresh().ok());
  EXPECT_EQ(cache.Enabled("street").value()->decisions.size(), 1u);
  EXPECT_EQ(cache.Get(key_).value()->decisions.size(), 1u);
  store.PutInPlace(store_.get());
  ASSERT_TRUE(cache.Refresh().ok());
  EXPECT_EQ(cache.Get(key_).value()->decisions.size(), world_.segments().size());
}

TEST_F(MapCacheTest, ADeletedMapIsForgotten) {
  const std::unique_ptr<MapStore> empty = NewInMemoryStore();
  ChangingStore store(store_.get());
  MapCache cache(&store);
  ASSERT_TRUE(cache.Enabled("street").ok());
  store.PutInPlace(empty.get());
  ASSERT_TRUE(cache.Refresh().ok());
  EXPECT_EQ(cache.Enabled("street").status().reason(), "MAP_NOT_FOUND");
  EXPECT_EQ(cache.Get(key_).status().reason(), "MAP_NOT_FOUND");
}

TEST_F(MapCacheTest, TellsWhichMapsThereAreAndWhichCannotBeOpened) {
  using Maps = std::map<std::string, bool>;
  ChangingStore store(store_.get());
  const std::unique_ptr<MapStore> empty = NewInMemoryStore();
  std::mutex mutex;
  Maps told;
  const auto is_told = [&](const Maps& maps) {
    return testing::WaitFor([&] {
      const std::lock_guard lock(mutex);
      return told == maps;
    });
  };
  MapCacheOptions options;
  options.poll_interval = 1ms;
  options.tell_maps = [&](const Maps& maps) {
    const std::lock_guard lock(mutex);
    told = maps;
  };
  MapCache cache(&store, options);
  EXPECT_TRUE(is_told({{"street", true}}));
  store.damaged = true;
  EXPECT_EQ(cache.Enabled("street").status().reason(), "DAMAGED_PLACE");
  EXPECT_TRUE(is_told({{"street", false}}));
  store.damaged = false;
  EXPECT_TRUE(cache.Enabled("street").ok());
  EXPECT_TRUE(is_told({{"street", true}}));
  store.PutInPlace(empty.get());
  EXPECT_TRUE(is_told({}));
}

TEST_F(MapCacheTest, AnExceptionInTheThreadIsBadHealthUntilItIsOver) {
  ChangingStore store(store_.get());
  std::atomic<int> turns = 0;
  Health health([&] { ++turns; });
  MapCacheOptions options;
  options.poll_interval = 1ms;
  options.health = &health;
  MapCache cache(&store, options);
  store.throws = true;
  EXPECT_TRUE(testing::WaitFor([&] { return !health.good(); }));
  store.throws = false;
  EXPECT_TRUE(testing::WaitFor([&] { return health.good(); }));
  EXPECT_TRUE(testing::WaitFor([&] { return turns == 2; }));
  EXPECT_TRUE(cache.Enabled("street").ok());
}

}  // namespace
}  // namespace maploc
