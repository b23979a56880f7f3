// A session manager over a store in memory that fails when a test wants it to.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "mapstore/store/in_memory_store.h"
#include "server/sessions/session_manager.h"
#include "tests/support/fake_clock.h"
#include "tests/support/forwarding_store.h"
#include "tests/support/seed.h"
#include "tests/support/stored_world.h"

namespace maploc {

// Refuses to write for as long as a test wants.
class FailingStore final : public testing::ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<SessionId>> AppendGroup(std::span<const SessionObservations> group) override {
    ++groups;
    for (const SessionObservations& one : group) {
      if (one.session == poisoned) return Internal("this session cannot be written");
    }
    if (failing) return Status(StatusCode::kUnavailable, failing_as, "the store fails");
    return store_->AppendGroup(group);
  }
  Result<SessionSummary> EndSession(const SessionId& id, SessionEnd end, std::int64_t end_unix_ns,
                                    std::span<const Observation> last) override {
    if (!hold_ends) return store_->EndSession(id, end, end_unix_ns, last);
    held = true;
    hold_ends.wait(true);
    return Status(StatusCode::kUnavailable, "STORE_BUSY", "another process holds the store");
  }
  Status StartSession(const Session& session) override {
    if (!refuses_starts) return store_->StartSession(session);
    return Status(StatusCode::kUnavailable, failing_as, "the store fails");
  }
  std::atomic<bool> failing = false;
  std::atomic<bool> refuses_starts = false;
  std::string failing_as = "DISK_FULL";
  std::atomic<int> groups = 0;
  SessionId poisoned;
  std::atomic<bool> hold_ends = false;  // an end waits while this is set, and then fails
  std::atomic<bool> held = false;
};

inline Observation Localized(SegmentId segment) {
  Observation observation;
  observation.segment = segment;
  observation.outcome = Outcome::kLocalized;
  observation.evidence.points = {20, 10};
  return observation;
}

class SessionManagerTest : public ::testing::Test {
 protected:
  SessionManagerTest() : store_(memory_.get()) {
    testing::DrawnWorldOptions tiny;
    tiny.points_a_metre = 1;
    map_ = testing::ImportWorld(testing::DrawnWorld(testing::TestRandom(), tiny), memory_.get());
    // The thread sleeps: tests flush when they mean to.
    options_.flush_interval = std::chrono::hours(1);
    Restart();
  }

  // What a restart of the server leaves: the store.
  void Restart() {
    manager_.reset();
    manager_ = SessionManager::Create(&store_, options_, clock_).value();
  }
  SessionId StartSession(const std::string& request_id = "") {
    const Result<Session> session = manager_->Start({map_, "rover", {}, request_id});
    EXPECT_TRUE(session.ok()) << session.status().ToString();
    return session->id;
  }
  void Query(const SessionId& id, SegmentId segment) {
    Result<SessionManager::Lease> lease = manager_->Enter(id);
    ASSERT_TRUE(lease.ok()) << lease.status().ToString();
    EXPECT_TRUE(lease->Record(Localized(segment)).ok());
  }
  std::size_t OnDisk(const SessionId& id) const { return memory_->ListObservations(id)->size(); }

  const std::unique_ptr<MapStore> memory_ = NewInMemoryStore();
  FailingStore store_;
  MapKey map_;
  testing::FakeClock clock_;
  SessionManagerOptions options_;
  Health health_;  // of those that hand it over in options_
  std::unique_ptr<SessionManager> manager_;
};

}  // namespace maploc
