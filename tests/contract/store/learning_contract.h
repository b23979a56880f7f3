// Random sessions in a map, and all that a store tells of what they taught.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/contract/store/store_contract.h"
#include "tests/support/seed.h"

namespace maploc::testing {

inline constexpr SegmentId kSegments = 3;

// A session with all that it will see.
struct Drive {
  SessionId id;
  std::int64_t start = 0;
  std::vector<Observation> seen;
};

// Whole numbers from `low` to `high`.
inline int Draw(Random& random, int low, int high) {
  return low + static_cast<int>(random.Below(static_cast<std::uint64_t>(high - low + 1)));
}

// Sessions whose ratios scatter widely, so that strategies change and changes are found; some start
// in the same nanosecond.
inline std::vector<Drive> RandomDrives(Random& random, int count) {
  std::vector<Drive> drives;
  for (int i = 0; i < count; ++i) {
    Drive drive{"d" + std::to_string(i), 1000 + Draw(random, 0, count / 2), {}};
    const int queries = Draw(random, 0, 12);
    for (int q = 1; q <= queries; ++q) {
      const int points = Draw(random, 0, 120);
      const int lines = Draw(random, 0, 25);
      drive.seen.push_back(Seen(q, Draw(random, -1, kSegments - 1), points, Draw(random, 0, points),
                                lines, Draw(random, 0, lines)));
      if (drive.seen.back().segment < 0) drive.seen.back() = OutOfMap(q);
      if (Draw(random, 0, 5) == 0) drive.seen.back().outcome = Outcome::kNoConsensus;
    }
    drives.push_back(std::move(drive));
  }
  return drives;
}

template <typename T>
void Shuffle(Random& random, std::vector<T>& values) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.Below(i)]);
}

// All that a store tells of a segment. The clock's times of pins are left out.
struct Told {
  SegmentStatistics statistics;
  StrategyDecision decision;
  std::optional<Strategy> pinned;
  SelectorOptions selector;
  std::vector<SegmentSessionRow> rows;
  std::vector<DecisionRecord> history;
  bool operator==(const Told&) const = default;
};

class LearningContract : public StoreContract {
 protected:
  // A store of its own with the map in it.
  void Fresh() {
    store_.reset();
    Open("store" + std::to_string(++stores_) + ".db");
    key_ = GiveMap(*store_, "yard", kSegments);
  }
  void StartAll(const std::vector<Drive>& drives) {
    for (const Drive& drive : drives) Start(drive.id, key_, drive.start);
  }
  // A part before the end, some of it twice, and the end once or twice.
  void Finish(const Drive& drive, Random& random) {
    const std::size_t part = random.Below(drive.seen.size() + 1);
    const std::vector<Observation> head(drive.seen.begin(), drive.seen.begin() + part);
    ASSERT_TRUE(Append(*store_, drive.id, head).ok());
    if (random.Below(3) == 0) {
      ASSERT_TRUE(Append(*store_, drive.id, head).ok());
    }
    const SessionSummary summary = End(drive.id, drive.seen);
    if (random.Below(3) == 0) {
      EXPECT_EQ(End(drive.id, drive.seen), summary);
    }
  }
  // A store of its own in which all of them were driven.
  void FreshAfter(const std::vector<Drive>& drives, Random& random) {
    Fresh();
    StartAll(drives);
    for (const Drive& drive : drives) Finish(drive, random);
  }
  std::vector<Told> Tell() {
    std::vector<Told> told;
    for (SegmentId id = 0; id < kSegments; ++id) {
      const SegmentSummary segment = At(key_, id);
      Told one{segment.statistics,
               segment.decision,
               segment.pinned,
               segment.selector,
               store_->ListRows(key_, id).value(),
               store_->ListDecisions(key_, id).value()};
      for (DecisionRecord& record : one.history) {
        if (record.cause == "pin" || record.cause == "unpin") record.time_unix_ns = 0;
      }
      told.push_back(std::move(one));
    }
    return told;
  }
  void ExpectVerified() { EXPECT_TRUE(store_->Verify().ok()) << store_->Verify().ToString(); }

  MapKey key_;
  int stores_ = 0;
};

}  // namespace maploc::testing
