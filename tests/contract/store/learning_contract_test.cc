// What segments know and have decided depends on which sessions count, not on the order in which
// they ended nor on what was revoked on the way (mapstore/store/map_store.h).
#include <algorithm>
#include <set>
#include <utility>

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

class InheritanceContract : public LearningContract {
 protected:
  // What a version tells, whichever it is.
  std::vector<Told> TellOf(const MapKey& key) {
    const MapKey mine = std::exchange(key_, key);
    std::vector<Told> told = Tell();
    key_ = mine;
    return told;
  }
  std::int64_t QueriesIn(const MapKey& key) {
    std::int64_t queries = 0;
    for (SegmentId id = 0; id < kSegments; ++id) queries += At(key, id).statistics.queries;
    return queries;
  }
};

INSTANTIATE_TEST_SUITE_P(Stores, InheritanceContract,
                         ::testing::Values(StoreKind::kInMemory, StoreKind::kSqlite), NameOf);

// The yard once more: neighbours share 20 of 123 landmarks, whose evidence is split.
TEST_P(InheritanceContract, ANewVersionStartsWithWhatTheOldOneTaught) {
  Fresh();
  Start("s", key_);
  std::vector<Observation> good_lines;
  for (int i = 1; i <= 100; ++i) good_lines.push_back(Seen(i, 0, 100, 20, 20, 16));
  End("s", good_lines);
  const MapKey second = GiveMap(*store_, "yard", kSegments);
  const SegmentSummary old = At(key_, 0);
  const SegmentSummary fresh = At(second, 0);
  EXPECT_EQ(fresh.decision.strategy, old.decision.strategy);
  EXPECT_EQ(fresh.decision.source, StrategySource::kLearned);
  EXPECT_NEAR(*fresh.statistics.PointInlierRatio(), 0.2, 1e-3);
  EXPECT_GT(fresh.statistics.queries, 85);
  EXPECT_GT(At(second, 1).statistics.queries, 0);
  EXPECT_NEAR(static_cast<double>(QueriesIn(second)), 100.0, 1.0);
  ASSERT_THAT(store_->ListRows(second, 0).value(), SizeIs(1));
  EXPECT_EQ(store_->ListRows(second, 0).value()[0].session, "s");
  EXPECT_EQ(At(key_, 0).statistics, old.statistics);
  ExpectVerified();
}

// Before the import, after it, revoked or not: what counts is which sessions count.
TEST_P(InheritanceContract, WhatIsInheritedFollowsTheSessionsOfTheOldVersion) {
  for (int repetition = 0; repetition < 2; ++repetition) {
    Random random = TestRandom(repetition);
    SCOPED_TRACE(::testing::Message() << "seed " << TestSeed(repetition));
    std::vector<Drive> drives = RandomDrives(random, 10);
    std::vector<Told> first_second;
    std::vector<Told> first_third;
    for (int order = 0; order < 3; ++order) {
      Fresh();
      StartAll(drives);
      MapKey second;
      MapKey third;
      for (std::size_t i = 0; i < drives.size(); ++i) {
        if (i == 3 * static_cast<std::size_t>(order)) second = GiveMap(*store_, "yard", kSegments);
        if (i == 7) third = GiveMap(*store_, "yard", kSegments);
        Finish(drives[i], random);
        if (random.Below(2) == 0) {
          ASSERT_TRUE(store_->RevokeSession(drives[i].id).ok());
        }
      }
      for (const Drive& drive : drives) {
        const bool out = drive.id == "d1" || drive.id == "d4";
        const Status status =
            out ? store_->RevokeSession(drive.id) : store_->ReinstateSession(drive.id);
        ASSERT_TRUE(status.ok());
      }
      ExpectVerified();
      if (order == 0) {
        first_second = TellOf(second);
        first_third = TellOf(third);
        EXPECT_FALSE(first_third[0].rows.empty());
      }
      EXPECT_EQ(TellOf(second), first_second) << "order " << order;
      EXPECT_EQ(TellOf(third), first_third) << "order " << order;
      Shuffle(random, drives);
    }
  }
}

TEST_P(InheritanceContract, AnotherPlaceInheritsNothing) {
  Fresh();
  Start("s", key_);
  End("s", {Seen(1, 0), Seen(2, 1)});
  auto writer = store_->BeginImport(YardInfo("yard"));
  ASSERT_TRUE(writer.ok());
  Segment moved = YardSegment(0);
  for (Eigen::Vector3d& point : moved.points.positions_in_map) point.x() += 1000.0;
  for (LineSegment3& line : moved.lines.segments_in_map) {
    line.start.x() += 1000.0;
    line.end.x() += 1000.0;
  }
  for (Eigen::Vector3d& position : moved.path_in_map) position.x() += 1000.0;
  ASSERT_TRUE((*writer)->AddSegment(moved).ok());
  ASSERT_TRUE((*writer)->Commit().ok());
  EXPECT_EQ(At({"yard", 2}, 0).statistics, SegmentStatistics{});
  const MapKey other = GiveMap(*store_, "alley", kSegments);
  EXPECT_EQ(QueriesIn(other), 0);
  ExpectVerified();
}

}  // namespace
}  // namespace maploc::testing
