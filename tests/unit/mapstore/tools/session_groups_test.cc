// Beside a server: sessions end while the sums are being read.
#include "mapstore/tools/session_groups.h"

#include <gmock/gmock.h>

#include "mapstore/store/in_memory_store.h"
#include "tests/support/forwarding_store.h"
#include "tests/support/seed.h"
#include "tests/support/stored_world.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

enum class After { kSessions, kSegments };

// A session starts and ends right after a chosen read, the first times that it is made.
class StoreOfABusyServer final : public testing::ForwardingStore {
 public:
  StoreOfABusyServer(MapStore* store, const MapKey& key, After after, int times)
      : ForwardingStore(store), key_(key), after_(after), times_(times) {}

  Result<std::vector<Session>> ListSessions() const override {
    auto sessions = ForwardingStore::ListSessions();
    if (after_ == After::kSessions) DriveBy();
    return sessions;
  }
  Result<std::vector<SegmentSummary>> ListSegments(const MapKey& key) const override {
    auto segments = ForwardingStore::ListSegments(key);
    if (after_ == After::kSegments) DriveBy();
    return segments;
  }

 private:
  void DriveBy() const {
    if (driven_ == times_) return;
    Session session{"busy-" + std::to_string(driven_++), key_, "r1", {}, 2000};
    ASSERT_TRUE(store_->StartSession(session).ok());
    Observation seen;
    seen.sequence = 1;
    seen.segment = 0;
    seen.outcome = Outcome::kLocalized;
    seen.evidence.points = {40, 30};
    ASSERT_TRUE(store_->EndSession(session.id, SessionEnd::kByRobot, 3000, {{seen}}).ok());
  }

  const MapKey key_;
  const After after_;
  const int times_;
  mutable int driven_ = 0;
};

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
  SessionGroupsTest() {
    testing::DrawnWorldOptions tiny;
    tiny.points_a_metre = 1;
    key_ = testing::ImportWorld(testing::DrawnWorld(testing::TestRandom(), tiny), store_.get());
  }

  const std::unique_ptr<MapStore> store_ = NewInMemoryStore();
  const GroupOptions recompute_ = {{}, "", true};
  MapKey key_;
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
