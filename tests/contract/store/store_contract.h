// The fixture of the contract: each promise is tested on every store (TEST_P), those of a store
// that outlives its process on the persistent ones.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/contract/store/store_fixture.h"
#include "tests/support/files.h"

namespace maploc::testing {

enum class StoreKind { kInMemory, kSqlite };

inline std::string NameOf(const ::testing::TestParamInfo<StoreKind>& kind) {
  return kind.param == StoreKind::kInMemory ? "InMemory" : "Sqlite";
}

class StoreContract : public ::testing::TestWithParam<StoreKind> {
 protected:
  void SetUp() override { Open(); }
  void Open(const std::string& file = "store.db") {
    store_.reset();
    if (GetParam() == StoreKind::kInMemory) {
      store_ = NewInMemoryStore();
      return;
    }
    auto opened = OpenSqliteStore(folder_.File(file));
    ASSERT_TRUE(opened.ok()) << opened.status().ToString();
    store_ = std::move(*opened);
  }
  void Start(const SessionId& id, const MapKey& map, std::int64_t start = 1000) {
    const Status status = store_->StartSession(OpenSession(id, map, start));
    ASSERT_TRUE(status.ok()) << status.ToString();
  }
  SessionSummary End(const SessionId& id, const std::vector<Observation>& last = {}) {
    auto summary = store_->EndSession(id, SessionEnd::kByRobot, 5000, last);
    EXPECT_TRUE(summary.ok()) << summary.status().ToString();
    return summary.ok() ? *summary : SessionSummary{};
  }
  SegmentSummary At(const MapKey& map, SegmentId id) {
    auto segment = store_->GetSegment(map, id);
    EXPECT_TRUE(segment.ok()) << segment.status().ToString();
    return segment.ok() ? *segment : SegmentSummary{};
  }
  std::int64_t Changes() { return store_->ChangeCounter().value(); }

  TemporaryFolder folder_;
  std::unique_ptr<MapStore> store_;
};

}  // namespace maploc::testing
