// Beside a server: sessions end while a report is being read.
#include "mapstore/tools/readings.h"

#include <gtest/gtest.h>

#include "mapstore/store/in_memory_store.h"
#include "tests/unit/mapstore/tools/busy_store.h"

namespace maploc {
namespace {

using testing::After;
using testing::StoreOfABusyServer;

class ReadingsTest : public ::testing::Test {
 protected:
  const std::unique_ptr<MapStore> store_ = NewInMemoryStore();
  const MapKey key_ = testing::GiveTinyWorld(store_.get());
};

TEST_F(ReadingsTest, AnExplanationAndItsHistoryTellOfOneState) {
  const StoreOfABusyServer store(store_.get(), key_, After::kSegment, 3);
  const auto read = ReadExplained(store, key_.name, 0);
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  EXPECT_EQ(read->history.size(), 3u);
  EXPECT_EQ(read->explanation.statistics, read->history.back().statistics);
  EXPECT_EQ(read->explanation.decision, read->history.back().decision);
}

TEST_F(ReadingsTest, ChangesAreOfTheSessionsThatTheSegmentsCount) {
  const StoreOfABusyServer store(store_.get(), key_, After::kSegments, 3);
  const auto read = ReadChanged(store, key_.name, std::nullopt);
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  EXPECT_EQ(read->map, key_);
  EXPECT_EQ(read->segments.front().statistics.sessions, 3);
  EXPECT_EQ(read->changes.size(), read->segments.size());
}

TEST_F(ReadingsTest, AStoreThatNeverStandsStillIsNotExplained) {
  const StoreOfABusyServer store(store_.get(), key_, After::kSegment, 1000);
  EXPECT_EQ(ReadExplained(store, key_.name, 0).status().reason(), "STORE_MOVES");
}

TEST_F(ReadingsTest, AStoreThatNeverStandsStillHasNoChanges) {
  const StoreOfABusyServer store(store_.get(), key_, After::kSegments, 1000);
  EXPECT_EQ(ReadChanged(store, key_.name, std::nullopt).status().reason(), "STORE_MOVES");
}

}  // namespace
}  // namespace maploc
