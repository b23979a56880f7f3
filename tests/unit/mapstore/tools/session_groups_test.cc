// Beside a server: sessions end while the sums are being read.
#include "mapstore/tools/session_groups.h"

#include <gmock/gmock.h>

#include "mapstore/store/in_memory_store.h"
#include "tests/support/forwarding_store.h"
#include "tests/unit/mapstore/tools/busy_store.h"

namespace maploc {
namespace {

using testing::After;
using ::testing::HasSubstr;
using testing::StoreOfABusyServer;

// Segment 0's stored sums are not those of its rows.
class DamagedStore final : public testing::ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<SegmentSummary>> ListSegments(const MapKey& key) const override {
    auto segments = ForwardingStore::ListSegments(key);
    if (segments.ok()) segments->front().statistics.point_inliers += 1.0;
    return segments;
  }
};

class SessionGroupsTest : public ::testing::TestWithParam<After> {
 protected:
  const std::unique_ptr<MapStore> store_ = NewInMemoryStore();
  const GroupOptions recompute_ = {{}, "", true};
  const MapKey key_ = testing::GiveTinyWorld(store_.get());
};

INSTANTIATE_TEST_SUITE_P(AfterEachRead, SessionGroupsTest,
                         ::testing::Values(After::kSessions, After::kSegments));

TEST_P(SessionGroupsTest, ASessionThatEndsInTheMiddleIsNoDamageAndIsCounted) {
  const StoreOfABusyServer store(store_.get(), key_, GetParam(), 3);
  const auto groups = ReadGroups(store, key_, recompute_);
  ASSERT_TRUE(groups.ok()) << groups.status().ToString();
  const SegmentStats& first = groups->front().segments.front();
  EXPECT_EQ(first.summary.statistics.sessions, 3);
  EXPECT_EQ(first.summary.statistics, store_->GetSegment(key_, 0)->statistics);
}

TEST_P(SessionGroupsTest, AStoreThatNeverStandsStillIsNotCalledDamaged) {
  const StoreOfABusyServer store(store_.get(), key_, GetParam(), 1000);
  const Status status = ReadGroups(store, key_, recompute_).status();
  EXPECT_EQ(status.code(), StatusCode::kUnavailable) << status.ToString();
  EXPECT_EQ(status.reason(), "STORE_MOVES");
  EXPECT_THAT(status.message(), HasSubstr("maploc-map backup"));
}

TEST_P(SessionGroupsTest, DamageIsTold) {
  const DamagedStore store(store_.get());
  const Status status = ReadGroups(store, key_, recompute_).status();
  EXPECT_EQ(status.code(), StatusCode::kDataLoss) << status.ToString();
  EXPECT_EQ(status.reason(), "DAMAGED_STORE");
  EXPECT_TRUE(ReadGroups(*store_, key_, recompute_).ok());
}

}  // namespace
}  // namespace maploc
