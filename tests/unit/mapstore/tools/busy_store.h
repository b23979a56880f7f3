// A store beside a server: sessions end while it is being read.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/forwarding_store.h"
#include "tests/support/seed.h"
#include "tests/support/stored_world.h"

namespace maploc::testing {

// A map of few landmarks, drawn with the test's seed.
inline MapKey GiveTinyWorld(MapStore* store) {
  DrawnWorldOptions tiny;
  tiny.points_a_metre = 1;
  return ImportWorld(DrawnWorld(TestRandom(), tiny), store);
}

enum class After { kSessions, kSegments, kSegment };

// A session in segment 0 starts and ends right after a chosen read, the first times that it is
// made.
class StoreOfABusyServer final : public ForwardingStore {
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
  Result<SegmentSummary> GetSegment(const MapKey& key, SegmentId id) const override {
    auto segment = ForwardingStore::GetSegment(key, id);
    if (after_ == After::kSegment) DriveBy();
    return segment;
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

}  // namespace maploc::testing
