// Many robots at once on one store: every observation is counted, and none twice.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "tests/contract/store/store_contract.h"

namespace maploc::testing {

// Each robot writes its queries in groups, every fifth group twice (a lost reply), and ends its
// session, half of them twice; some groups come with the end alone. Returns how many calls failed.
inline int DriveRobots(MapStore& store, const MapKey& key, int robots, int queries_each,
                       int segments) {
  constexpr int kGroup = 50;
  std::atomic<int> failures = 0;
  const auto drive = [&](int robot) {
    const SessionId id = "robot" + std::to_string(robot);
    failures += !store.StartSession(OpenSession(id, key, 1000 + robot)).ok();
    std::vector<Observation> group;
    for (int q = 1; q <= queries_each; ++q) {
      group.push_back(Seen(q, static_cast<SegmentId>((robot + q) % segments), 100, 60));
      if (q % kGroup != 0) continue;
      failures += !Append(store, id, group).ok();
      if ((q / kGroup + robot) % 5 == 0) failures += !Append(store, id, group).ok();
      group.clear();
    }
    const auto first = store.EndSession(id, SessionEnd::kByRobot, 9000, group);
    failures += !first.ok();
    if (robot % 2 == 0) {
      const auto second = store.EndSession(id, SessionEnd::kByRobot, 9999, group);
      failures += !second.ok() || !first.ok() || *second != *first;
    }
  };
  std::vector<std::thread> threads;
  for (int robot = 0; robot < robots; ++robot) threads.emplace_back(drive, robot);
  for (std::thread& thread : threads) thread.join();
  return failures;
}

// What the store holds afterwards: sums of rows, and each robot's sequences without a gap.
inline void ExpectAllCountedOnce(const MapStore& store, const MapKey& key, int robots,
                                 int queries_each, int segments) {
  std::int64_t counted = 0;
  std::int64_t inliers = 0;
  for (SegmentId id = 0; id < segments; ++id) {
    const auto rows = store.ListRows(key, id);
    ASSERT_TRUE(rows.ok());
    EXPECT_EQ(rows->size(), static_cast<std::size_t>(robots));
    for (const SegmentSessionRow& row : *rows) {
      counted += row.queries;
      inliers += row.point_inliers;
    }
    EXPECT_EQ(store.GetSegment(key, id)->statistics.sessions, robots);
  }
  EXPECT_EQ(counted, std::int64_t{robots} * queries_each);
  EXPECT_EQ(inliers, 60 * counted);
  for (int robot = 0; robot < robots; ++robot) {
    const auto seen = store.ListObservations("robot" + std::to_string(robot));
    ASSERT_TRUE(seen.ok());
    ASSERT_EQ(seen->size(), static_cast<std::size_t>(queries_each));
    EXPECT_EQ(seen->back().sequence, queries_each);
  }
  EXPECT_TRUE(store.Verify().ok()) << store.Verify().ToString();
}

}  // namespace maploc::testing
