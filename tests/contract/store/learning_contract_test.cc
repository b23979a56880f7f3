// What segments know and have decided depends on which sessions count, not on the order in which
// they ended nor on what was revoked on the way (mapstore/store/map_store.h).
#include "tests/contract/store/learning_contract.h"

#include <set>

#include <gmock/gmock.h>

namespace maploc::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

INSTANTIATE_TEST_SUITE_P(Stores, LearningContract,
                         ::testing::Values(StoreKind::kInMemory, StoreKind::kSqlite), NameOf);

TEST_P(LearningContract, TheOrderOfEndsDoesNotMatter) {
  for (int repetition = 0; repetition < 3; ++repetition) {
    Random random = TestRandom(repetition);
    SCOPED_TRACE(::testing::Message() << "seed " << TestSeed(repetition));
    std::vector<Drive> drives = RandomDrives(random, 14);
    std::vector<Told> first;
    for (int order = 0; order < 4; ++order) {
      FreshAfter(drives, random);
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

// So many that a store which remembers where it was goes on from many such places.
TEST_P(LearningContract, HundredsOfSessionsInAnyOrderWithRevokesBetween) {
  Random random = TestRandom();
  SCOPED_TRACE(::testing::Message() << "seed " << TestSeed());
  std::vector<Drive> drives = RandomDrives(random, 160);
  FreshAfter(drives, random);
  const std::vector<Told> in_order = Tell();

  Fresh();
  StartAll(drives);
  Shuffle(random, drives);
  std::set<SessionId> revoked;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    Finish(drives[i], random);
    if (i % 10 != 0) continue;
    const SessionId& other = drives[random.Below(i + 1)].id;
    const bool is_out = !revoked.insert(other).second;
    if (is_out) revoked.erase(other);
    ASSERT_TRUE((is_out ? store_->ReinstateSession(other) : store_->RevokeSession(other)).ok());
  }
  ExpectVerified();
  for (const SessionId& id : revoked) ASSERT_TRUE(store_->ReinstateSession(id).ok());
  EXPECT_EQ(Tell(), in_order);
  ExpectVerified();
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
  ASSERT_TRUE(Append(*store_, "s", std::vector{Seen(1, 0)}).ok());
  ASSERT_TRUE(store_->RevokeSession("s").ok());
  ASSERT_TRUE(Append(*store_, "s", std::vector{Seen(2, 1)}).ok());
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

TEST_P(LearningContract, ChangedSegmentsAreTheOnesThatASessionAPinOrARevokeTouched) {
  Fresh();
  const auto changed_since = [&](std::int64_t since) {
    std::set<SegmentId> ids;
    const std::vector<SegmentSummary> changed = store_->ListChangedSegments(key_, since).value();
    for (const SegmentSummary& segment : changed) {
      EXPECT_EQ(segment.statistics, At(key_, segment.id).statistics);
      EXPECT_EQ(segment.decision, At(key_, segment.id).decision);
      ids.insert(segment.id);
    }
    return ids;
  };
  const std::int64_t at_first = Changes();
  EXPECT_THAT(changed_since(at_first), IsEmpty());
  Start("s", key_);
  End("s", {Seen(1, 0), OutOfMap(2)});
  const std::int64_t after_end = Changes();
  EXPECT_THAT(changed_since(at_first), ElementsAre(0));
  EXPECT_THAT(changed_since(after_end), IsEmpty());
  ASSERT_TRUE(store_->PinStrategy(key_, 2, Strategy::k2P).ok());
  EXPECT_THAT(changed_since(after_end), ElementsAre(2));
  EXPECT_THAT(changed_since(at_first), ElementsAre(0, 2));
  const std::int64_t after_pin = Changes();
  ASSERT_TRUE(store_->RevokeSession("s").ok());  // nothing is known of segment 0 any more
  EXPECT_THAT(changed_since(after_pin), Contains(0));
  EXPECT_THAT(changed_since(Changes()), IsEmpty());
  EXPECT_EQ(store_->ListChangedSegments({"nowhere", 1}, 0).status().code(), StatusCode::kNotFound);
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
  EXPECT_EQ(store_->RevokeSession("nobody").reason(), "SESSION_NOT_FOUND");
  EXPECT_EQ(store_->ReinstateSession("nobody").code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace maploc::testing
