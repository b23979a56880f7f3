// What segments know and have decided depends on which sessions count, not on the order in which
// they ended nor on what was revoked on the way (mapstore/store/map_store.h).
#include <algorithm>
#include <set>

#include <gmock/gmock.h>

#include "tests/contract/store/store_contract.h"
#include "tests/support/seed.h"

namespace maploc::testing {
namespace {

using ::testing::SizeIs;

constexpr SegmentId kSegments = 3;

// A session with all that it will see.
struct Drive {
  SessionId id;
  std::int64_t start = 0;
  std::vector<Observation> seen;
};

// Whole numbers from `low` to `high`.
int Draw(Random& random, int low, int high) {
  return low + static_cast<int>(random.Below(static_cast<std::uint64_t>(high - low + 1)));
}

// Sessions whose ratios scatter widely, so that strategies change and changes are found; some start
// in the same nanosecond.
std::vector<Drive> RandomDrives(Random& random, int count) {
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
    ASSERT_TRUE(store_->AppendObservations(drive.id, head).ok());
    if (random.Below(3) == 0) {
      ASSERT_TRUE(store_->AppendObservations(drive.id, head).ok());
    }
    const SessionSummary summary = End(drive.id, drive.seen);
    if (random.Below(3) == 0) {
      EXPECT_EQ(End(drive.id, drive.seen), summary);
    }
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

INSTANTIATE_TEST_SUITE_P(Stores, LearningContract,
                         ::testing::Values(StoreKind::kInMemory, StoreKind::kSqlite), NameOf);

TEST_P(LearningContract, TheOrderOfEndsDoesNotMatter) {
  for (int repetition = 0; repetition < 3; ++repetition) {
    Random random = TestRandom(repetition);
    SCOPED_TRACE(::testing::Message() << "seed " << TestSeed(repetition));
    std::vector<Drive> drives = RandomDrives(random, 14);
    std::vector<Told> first;
    for (int order = 0; order < 4; ++order) {
      Fresh();
      StartAll(drives);
      for (const Drive& drive : drives) Finish(drive, random);
      ExpectVerified();
      if (order == 0) first = Tell();
      EXPECT_EQ(Tell(), first) << "order " << order;
      Shuffle(random, drives);
    }
    for (const Told& told : first) {
      ASSERT_FALSE(told.history.empty());
      EXPECT_EQ(told.history.back().decision, told.decision);
      EXPECT_EQ(told.history.back().statistics, told.statistics);
    }
  }
}

TEST_P(LearningContract, ARevokedSessionHasNeverBeen) {
  for (int repetition = 0; repetition < 4; ++repetition) {
    Random random = TestRandom(repetition);
    SCOPED_TRACE(::testing::Message() << "seed " << TestSeed(repetition));
    std::vector<Drive> drives = RandomDrives(random, 14);
    std::set<SessionId> revoked;
    for (const Drive& drive : drives) {
      if (random.Below(3) == 0) revoked.insert(drive.id);
    }
    Fresh();
    for (const Drive& drive : drives) {
      if (revoked.contains(drive.id)) continue;
      Start(drive.id, key_, drive.start);
      Finish(drive, random);
    }
    const std::vector<Told> never = Tell();

    // Before its end, after it, twice, taken back and done again, in any order.
    Fresh();
    Shuffle(random, drives);
    StartAll(drives);
    for (const Drive& drive : drives) {
      const bool out = revoked.contains(drive.id);
      if (out && random.Below(2) == 0) {
        ASSERT_TRUE(store_->RevokeSession(drive.id).ok());
      }
      Finish(drive, random);
      if (!out && random.Below(3) == 0) {
        ASSERT_TRUE(store_->RevokeSession(drive.id).ok());
      }
    }
    Shuffle(random, drives);
    for (const Drive& drive : drives) {
      const Status status = revoked.contains(drive.id) ? store_->RevokeSession(drive.id)
                                                       : store_->ReinstateSession(drive.id);
      ASSERT_TRUE(status.ok()) << status.ToString();
    }
    EXPECT_EQ(Tell(), never);
    ExpectVerified();
  }
}

TEST_P(LearningContract, PinsStayWhatSessionsDoAround) {
  Random random = TestRandom();
  const std::vector<Drive> drives = RandomDrives(random, 8);
  Fresh();
  for (int i = 0; i < 4; ++i) {
    Start(drives[i].id, key_, drives[i].start);
    Finish(drives[i], random);
  }
  ASSERT_TRUE(store_->PinStrategy(key_, 1, Strategy::k2P).ok());
  ASSERT_TRUE(store_->PinStrategy(key_, 0, Strategy::k2P).ok());
  ASSERT_TRUE(store_->PinStrategy(key_, 0, std::nullopt).ok());
  const std::vector<Told> before = Tell();
  for (int i = 4; i < 8; ++i) {
    Start(drives[i].id, key_, drives[i].start);
    Finish(drives[i], random);
  }
  EXPECT_EQ(At(key_, 1).decision.source, StrategySource::kPinned);
  for (int i = 4; i < 8; ++i) ASSERT_TRUE(store_->RevokeSession(drives[i].id).ok());
  EXPECT_EQ(Tell(), before);
  EXPECT_EQ(At(key_, 1).pinned, Strategy::k2P);
  ExpectVerified();
}

// An operator takes out a robot whose session still runs: queries go on, and do not count.
TEST_P(LearningContract, AnOpenSessionCanBeRevoked) {
  Fresh();
  const std::vector<Told> nothing = Tell();
  Start("s", key_);
  ASSERT_TRUE(store_->AppendObservations("s", std::vector{Seen(1, 0)}).ok());
  ASSERT_TRUE(store_->RevokeSession("s").ok());
  ASSERT_TRUE(store_->AppendObservations("s", std::vector{Seen(2, 1)}).ok());
  const SessionSummary summary = End("s", {Seen(3, 1)});
  EXPECT_EQ(summary.queries, 3);
  EXPECT_EQ(Tell(), nothing);
  EXPECT_TRUE(store_->GetSession("s")->revoked);
  EXPECT_THAT(store_->ListObservations("s").value(), SizeIs(3));
  EXPECT_EQ(End("s"), summary);
  ASSERT_TRUE(store_->ReinstateSession("s").ok());
  EXPECT_FALSE(store_->GetSession("s")->revoked);
  EXPECT_EQ(At(key_, 1).statistics.queries, 2);
  ExpectVerified();
}

TEST_P(LearningContract, ARevokeIsSeenByCachesOnceAndNamesWhatIsUnknown) {
  Fresh();
  Start("s", key_);
  const SessionSummary summary = End("s", {Seen(1, 0)});
  const std::int64_t before = Changes();
  ASSERT_TRUE(store_->RevokeSession("s").ok());
  const std::int64_t revoked = Changes();
  EXPECT_GT(revoked, before);
  ASSERT_TRUE(store_->RevokeSession("s").ok());
  EXPECT_EQ(Changes(), revoked);
  EXPECT_EQ(End("s"), summary);  // what was answered stays answered
  EXPECT_EQ(store_->RevokeSession("nobody").reason(), "UNKNOWN_SESSION");
  EXPECT_EQ(store_->ReinstateSession("nobody").code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace maploc::testing
