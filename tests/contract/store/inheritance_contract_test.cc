// A new version of a map starts with what sessions taught the older ones, and nothing is lost,
// doubled or blurred on the way (mapstore/store/FORMAT.md).
#include <array>
#include <map>
#include <utility>

#include <gmock/gmock.h>

#include "tests/contract/store/learning_contract.h"

namespace maploc::testing {
namespace {

using ::testing::SizeIs;

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
  // The yard with its first segment cut in two, which share 20 points.
  MapKey GiveCutYard() {
    auto writer = store_->BeginImport(YardInfo("yard"));
    EXPECT_TRUE(writer.ok());
    EXPECT_TRUE((*writer)->AddSegment(PartOf(YardSegment(0), 0, 0, 69)).ok());
    EXPECT_TRUE((*writer)->AddSegment(PartOf(YardSegment(0), 1, 50, 119)).ok());
    EXPECT_TRUE((*writer)->AddSegment(PartOf(YardSegment(1), 2, 0, 119)).ok());
    EXPECT_TRUE((*writer)->AddSegment(PartOf(YardSegment(2), 3, 0, 119)).ok());
    EXPECT_TRUE((*writer)->Commit().ok());
    return (*writer)->key();
  }
  // Of a session in all segments of a version: queries, localized, matches and inliers.
  std::map<SessionId, std::array<std::int64_t, 6>> CountsIn(const MapKey& key, int segments) {
    std::map<SessionId, std::array<std::int64_t, 6>> counts;
    for (SegmentId id = 0; id < segments; ++id) {
      const std::vector<SegmentSessionRow> rows = store_->ListRows(key, id).value();
      for (const SegmentSessionRow& row : rows) {
        auto& sum = counts[row.session];
        const std::array all = {
            row.queries,       row.localized,           row.point_matches,
            row.point_inliers, row.usable_line_matches, row.usable_line_inliers};
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += all[i];
      }
    }
    return counts;
  }

 private:
  // The points first ... last of a segment, and all of its lines.
  static Segment PartOf(Segment segment, SegmentId id, std::size_t first, std::size_t last) {
    const auto whole = std::exchange(segment.points, {});
    segment.id = id;
    segment.points.descriptors.kind = whole.descriptors.kind;
    for (std::size_t i = first; i <= last; ++i) {
      segment.points.ids.push_back(whole.ids[i]);
      segment.points.positions_in_map.push_back(whole.positions_in_map[i]);
      segment.points.descriptor_landmark.push_back(static_cast<int>(i - first));
      segment.points.descriptors.bytes.insert(segment.points.descriptors.bytes.end(), 32, 7);
    }
    return segment;
  }
};

INSTANTIATE_TEST_SUITE_P(Stores, InheritanceContract,
                         ::testing::Values(StoreKind::kInMemory, StoreKind::kSqlite), NameOf);

// The yard once more: that neighbours share 20 of 123 landmarks changes nothing.
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
  EXPECT_EQ(fresh.statistics, old.statistics);
  EXPECT_EQ(QueriesIn(second), 100);
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

TEST_P(InheritanceContract, TheSameMapOnceMoreChangesNothing) {
  for (int repetition = 0; repetition < 3; ++repetition) {
    Random random = TestRandom(repetition);
    SCOPED_TRACE(::testing::Message() << "seed " << TestSeed(repetition));
    const std::vector<Drive> drives = RandomDrives(random, 12);
    FreshAfter(drives, random);
    const std::vector<Told> told = Tell();
    for (int version = 2; version <= 4; ++version) {
      const MapKey again = GiveMap(*store_, "yard", kSegments);
      EXPECT_EQ(again.version, version);
      EXPECT_EQ(TellOf(again), told) << "version " << version;
    }
    ExpectVerified();
  }
}

// A segment cut in two: all that a session counted is counted once, then and in later versions.
TEST_P(InheritanceContract, ACutConservesWhatSessionsCounted) {
  for (int repetition = 0; repetition < 3; ++repetition) {
    Random random = TestRandom(repetition);
    SCOPED_TRACE(::testing::Message() << "seed " << TestSeed(repetition));
    const std::vector<Drive> drives = RandomDrives(random, 12);
    FreshAfter(drives, random);
    const auto counts = CountsIn(key_, kSegments);
    const MapKey cut = GiveCutYard();
    EXPECT_EQ(CountsIn(cut, kSegments + 1), counts);
    EXPECT_FALSE(store_->ListRows(cut, 0).value().empty());
    EXPECT_FALSE(store_->ListRows(cut, 1).value().empty());
    const MapKey cut_again = GiveCutYard();
    EXPECT_EQ(TellOf(cut_again), TellOf(cut));
    const MapKey whole = GiveMap(*store_, "yard", kSegments);
    EXPECT_EQ(CountsIn(whole, kSegments), counts);
    ExpectVerified();
  }
}

TEST_P(InheritanceContract, ARevokeReachesAllLaterVersionsAsIfTheSessionHadNeverBeen) {
  for (int repetition = 0; repetition < 3; ++repetition) {
    Random random = TestRandom(repetition);
    SCOPED_TRACE(::testing::Message() << "seed " << TestSeed(repetition));
    const std::vector<Drive> drives = RandomDrives(random, 10);
    std::vector<std::vector<Told>> never;
    for (const bool was : {false, true}) {
      Fresh();
      StartAll(drives);
      for (const Drive& drive : drives) {
        if (was || drive.id != "d3") Finish(drive, random);
      }
      std::vector<MapKey> versions = {GiveMap(*store_, "yard", kSegments), GiveCutYard(),
                                      GiveMap(*store_, "yard", kSegments)};
      if (was) {
        ASSERT_TRUE(store_->RevokeSession("d3").ok());
      }
      std::vector<std::vector<Told>> told;
      for (const MapKey& version : versions) told.push_back(TellOf(version));
      if (!was) never = told;
      EXPECT_EQ(told, never);
      ExpectVerified();
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
