// What every store promises (mapstore/store/map_store.h), once, for all of them.
#include <atomic>
#include <functional>
#include <thread>

#include <gmock/gmock.h>

#include "tests/contract/store/store_fixture.h"

namespace maploc::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

enum class StoreKind { kInMemory, kSqlite };

std::string NameOf(const ::testing::TestParamInfo<StoreKind>& kind) {
  return kind.param == StoreKind::kInMemory ? "InMemory" : "Sqlite";
}

class StoreContract : public ::testing::TestWithParam<StoreKind> {
 protected:
  void SetUp() override { Open(); }
  void Open() {
    store_.reset();
    if (GetParam() == StoreKind::kInMemory) {
      store_ = NewInMemoryStore();
      return;
    }
    auto opened = OpenSqliteStore(folder_.File("store.db"));
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

INSTANTIATE_TEST_SUITE_P(Stores, StoreContract,
                         ::testing::Values(StoreKind::kInMemory, StoreKind::kSqlite), NameOf);

// Promises of a store that outlives its process.
class PersistentStoreContract : public StoreContract {};
INSTANTIATE_TEST_SUITE_P(Stores, PersistentStoreContract, ::testing::Values(StoreKind::kSqlite),
                         NameOf);

TEST_P(StoreContract, AMapComesBackAsItWentIn) {
  const MapKey key = GiveMap(*store_);
  const auto map = store_->GetMap("yard");
  ASSERT_TRUE(map.ok());
  const MapInfo& info = map->info;
  EXPECT_EQ(info.key, (MapKey{"yard", 1}));
  EXPECT_TRUE(info.metric);
  EXPECT_EQ(info.created_unix_ns, YardInfo().created_unix_ns);
  EXPECT_EQ(info.map_from_source.scale, YardInfo().map_from_source.scale);
  EXPECT_EQ(info.map_from_source.rotation.coeffs(), YardInfo().map_from_source.rotation.coeffs());
  EXPECT_EQ(info.map_from_source.translation, YardInfo().map_from_source.translation);
  EXPECT_EQ(info.point_descriptor, YardInfo().point_descriptor);
  EXPECT_EQ(info.line_descriptor, YardInfo().line_descriptor);

  const auto loaded = store_->LoadSegment(key, 1);
  ASSERT_TRUE(loaded.ok()) << loaded.status().ToString();
  const Segment& got = **loaded;
  const Segment want = YardSegment(1);
  EXPECT_EQ(got.map, key);
  EXPECT_EQ(got.id, 1);
  EXPECT_EQ(got.path_in_map, want.path_in_map);
  EXPECT_EQ(got.points.ids, want.points.ids);
  EXPECT_EQ(got.points.positions_in_map, want.points.positions_in_map);
  EXPECT_EQ(got.points.descriptors.kind, want.points.descriptors.kind);
  EXPECT_EQ(got.points.descriptors.bytes, want.points.descriptors.bytes);
  EXPECT_EQ(got.points.descriptor_landmark, want.points.descriptor_landmark);
  EXPECT_EQ(got.lines.ids, want.lines.ids);
  ASSERT_EQ(got.lines.size(), want.lines.size());
  for (int i = 0; i < got.lines.size(); ++i) {
    EXPECT_EQ(got.lines.segments_in_map[i].start, want.lines.segments_in_map[i].start);
    EXPECT_EQ(got.lines.segments_in_map[i].end, want.lines.segments_in_map[i].end);
  }
  EXPECT_EQ(got.lines.descriptors.bytes, want.lines.descriptors.bytes);
  EXPECT_EQ(got.lines.descriptor_landmark, want.lines.descriptor_landmark);
}

TEST_P(StoreContract, ALandmarkInTwoSegmentsCountsOnceInTheMap) {
  const MapKey key = GiveMap(*store_);
  const auto map = store_->GetMap(key);
  ASSERT_TRUE(map.ok());
  EXPECT_EQ(map->segments, 3);
  EXPECT_EQ(map->points, 320);      // 3 x 120, of which 2 x 20 twice
  EXPECT_EQ(map->lines, 7);         // 3 x 2 and the shared one
  EXPECT_EQ(map->usable_lines, 4);  // 3 and the shared one
  const SegmentSummary segment = At(key, 2);
  EXPECT_EQ(segment.points, 120);
  EXPECT_EQ(segment.lines, 3);
  EXPECT_EQ(segment.usable_lines, 2);
  EXPECT_EQ(segment.path_in_map, YardSegment(2).path_in_map);
}

TEST_P(StoreContract, AnImportIsInvisibleUntilItsCommit) {
  const std::int64_t before = Changes();
  auto writer = store_->BeginImport(YardInfo());
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE((*writer)->AddSegment(YardSegment(0)).ok());
  EXPECT_THAT(store_->ListMaps().value(), IsEmpty());
  EXPECT_EQ(store_->GetMap("yard").status().code(), StatusCode::kNotFound);
  EXPECT_EQ(store_->ListSegments((*writer)->key()).status().code(), StatusCode::kNotFound);
  EXPECT_EQ(store_->LoadSegment((*writer)->key(), 0).status().code(), StatusCode::kNotFound);
  EXPECT_EQ(store_->StartSession(OpenSession("s", (*writer)->key())).code(), StatusCode::kNotFound);
  EXPECT_EQ(Changes(), before);
  ASSERT_TRUE((*writer)->Commit().ok());
  EXPECT_THAT(store_->ListMaps().value(), SizeIs(1));
  EXPECT_GT(Changes(), before);
  EXPECT_TRUE(store_->Verify().ok());
}

TEST_P(StoreContract, AnImportThatIsDroppedLeavesNothing) {
  {
    auto writer = store_->BeginImport(YardInfo());
    ASSERT_TRUE((*writer)->AddSegment(YardSegment(0)).ok());
    ASSERT_TRUE((*writer)->AddSegment(YardSegment(1)).ok());
  }
  EXPECT_THAT(store_->ListMaps().value(), IsEmpty());
  EXPECT_EQ(GiveMap(*store_).version, 1);
}

TEST_P(StoreContract, ASweepSparesALivingImport) {
  auto writer = store_->BeginImport(YardInfo());
  ASSERT_TRUE((*writer)->AddSegment(YardSegment(0)).ok());
  ASSERT_TRUE(store_->SweepAbandonedImports().ok());
  auto other = store_->BeginImport(YardInfo("other"));
  ASSERT_TRUE(other.ok());
  ASSERT_TRUE((*writer)->AddSegment(YardSegment(1)).ok());
  ASSERT_TRUE((*writer)->Commit().ok());
  EXPECT_EQ(store_->GetMap("yard")->segments, 2);
}

TEST_P(StoreContract, TwoImportsOfOneNameBecomeTwoVersions) {
  auto first = store_->BeginImport(YardInfo());
  auto second = store_->BeginImport(YardInfo());
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_NE((*first)->key().version, (*second)->key().version);
  ASSERT_TRUE((*first)->AddSegment(YardSegment(0)).ok());
  ASSERT_TRUE((*second)->AddSegment(YardSegment(0)).ok());
  ASSERT_TRUE((*second)->Commit().ok());
  ASSERT_TRUE((*first)->Commit().ok());
  EXPECT_EQ(store_->GetMap("yard")->info.key.version, 2);
  EXPECT_TRUE(store_->GetMap(MapKey{"yard", 1}).ok());
}

TEST_P(StoreContract, OldVersionsStayAndTheNewestIsListed) {
  const MapKey old = GiveMap(*store_, "yard", 3);
  GiveMap(*store_, "alley", 1);
  Start("s", old);
  const MapKey fresh = GiveMap(*store_, "yard", 2);
  EXPECT_EQ(fresh.version, 2);
  const auto maps = store_->ListMaps().value();
  ASSERT_THAT(maps, SizeIs(2));
  EXPECT_EQ(maps[0].info.key, (MapKey{"alley", 1}));
  EXPECT_EQ(maps[1].info.key, fresh);
  End("s", {Seen(1, 2)});
  EXPECT_EQ(At(old, 2).statistics.queries, 1);
  EXPECT_EQ(At(fresh, 1).statistics.queries, 0);
}

TEST_P(StoreContract, ARefusedSegmentLeavesTheImportAsItWas) {
  auto writer = store_->BeginImport(YardInfo());
  ASSERT_TRUE((*writer)->AddSegment(YardSegment(0)).ok());
  Segment nan = YardSegment(1);
  nan.points.positions_in_map[3].y() = std::numeric_limits<double>::quiet_NaN();
  const Status refused = (*writer)->AddSegment(nan);
  EXPECT_EQ(refused.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(refused.message(), ::testing::HasSubstr("points.positions_in_map[3]"));
  EXPECT_EQ((*writer)->AddSegment(YardSegment(2)).code(), StatusCode::kInvalidArgument);  // a gap
  ASSERT_TRUE((*writer)->AddSegment(YardSegment(1)).ok());
  ASSERT_TRUE((*writer)->Commit().ok());
  EXPECT_EQ((*writer)->Commit().code(), StatusCode::kFailedPrecondition);
  EXPECT_EQ((*writer)->AddSegment(YardSegment(2)).code(), StatusCode::kFailedPrecondition);
  EXPECT_EQ(store_->GetMap("yard")->segments, 2);
}

TEST_P(StoreContract, AMapWithoutSegmentsOrWithABadNameIsRefused) {
  auto writer = store_->BeginImport(YardInfo());
  EXPECT_EQ((*writer)->Commit().reason(), "EMPTY_MAP");
  EXPECT_EQ(store_->BeginImport(YardInfo("")).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(store_->BeginImport(YardInfo("a\nb")).status().code(), StatusCode::kInvalidArgument);
  MapInfo flat = YardInfo();
  flat.map_from_source.scale = 0.0;
  EXPECT_EQ(store_->BeginImport(flat).status().code(), StatusCode::kInvalidArgument);
}

TEST_P(StoreContract, WhatIsUnknownIsNotFound) {
  const MapKey key = GiveMap(*store_);
  const MapKey none{"yard", 7};
  const auto not_found = StatusCode::kNotFound;
  EXPECT_EQ(store_->GetMap("nowhere").status().code(), not_found);
  EXPECT_EQ(store_->GetMap(none).status().code(), not_found);
  EXPECT_EQ(store_->ListSegments(none).status().code(), not_found);
  EXPECT_EQ(store_->GetSegment(key, 3).status().code(), not_found);
  EXPECT_EQ(store_->GetSegment(key, -1).status().code(), not_found);
  EXPECT_EQ(store_->LoadSegment(key, 3).status().code(), not_found);
  EXPECT_EQ(store_->ListRows(key, 3).status().code(), not_found);
  EXPECT_EQ(store_->ListDecisions(key, 3).status().code(), not_found);
  EXPECT_EQ(store_->PinStrategy(key, 3, Strategy::k2P).code(), not_found);
  EXPECT_EQ(store_->StartSession(OpenSession("s", none)).code(), not_found);
  EXPECT_EQ(store_->GetSession("s").status().code(), not_found);
  EXPECT_EQ(store_->ListObservations("s").status().code(), not_found);
  EXPECT_EQ(store_->AppendObservations("s", {}).code(), not_found);
  EXPECT_EQ(store_->EndSession("s", SessionEnd::kIdle, 1, {}).status().code(), not_found);
}

TEST_P(StoreContract, ASessionComesBackAsItStarted) {
  const MapKey key = GiveMap(*store_);
  Start("b", key, 2000);
  Start("c", key, 1000);
  Start("a", key, 2000);
  EXPECT_EQ(store_->StartSession(OpenSession("a", key)).code(), StatusCode::kAlreadyExists);
  EXPECT_EQ(store_->StartSession(OpenSession("", key)).code(), StatusCode::kInvalidArgument);
  const auto sessions = store_->ListSessions().value();
  ASSERT_THAT(sessions, SizeIs(3));
  EXPECT_EQ(sessions[0].id + sessions[1].id + sessions[2].id, "cab");
  const Session session = store_->GetSession("b").value();
  EXPECT_EQ(session.map, key);
  EXPECT_EQ(session.robot, "r2");
  EXPECT_EQ(session.labels, OpenSession("b", key).labels);
  EXPECT_EQ(session.start_unix_ns, 2000);
  EXPECT_EQ(session.end, SessionEnd::kOpen);
}

TEST_P(StoreContract, AnObservationIsKeptOnceAndWhole) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  const std::vector<Observation> both = {Seen(1, 0), OutOfMap(2)};
  ASSERT_TRUE(store_->AppendObservations("s", both).ok());
  ASSERT_TRUE(store_->AppendObservations("s", both).ok());
  ASSERT_TRUE(store_->AppendObservations("s", std::vector{Seen(1, 2, 7, 7)}).ok());
  const auto kept = store_->ListObservations("s").value();
  ASSERT_THAT(kept, SizeIs(2));
  const Observation want = Seen(1, 0);
  EXPECT_EQ(kept[0].segment, 0);
  EXPECT_EQ(kept[0].outcome, want.outcome);
  EXPECT_EQ(kept[0].evidence.points, want.evidence.points);
  EXPECT_EQ(kept[0].evidence.usable_lines, want.evidence.usable_lines);
  EXPECT_EQ(kept[0].evidence.vertical_lines, want.evidence.vertical_lines);
  EXPECT_EQ(kept[0].evidence.strategy, want.evidence.strategy);
  EXPECT_EQ(kept[0].evidence.fell_back, want.evidence.fell_back);
  EXPECT_EQ(kept[0].evidence.iterations, want.evidence.iterations);
  EXPECT_EQ(kept[0].evidence.gravity_disagreement_rad, want.evidence.gravity_disagreement_rad);
  EXPECT_EQ(kept[0].evidence.confidence, want.evidence.confidence);
  EXPECT_EQ(kept[0].total_ms, want.total_ms);
  EXPECT_EQ(kept[0].time_unix_ns, want.time_unix_ns);
  EXPECT_EQ(kept[1].outcome, Outcome::kOutOfMap);
  EXPECT_EQ(kept[1].segment, -1);
}

TEST_P(StoreContract, ARefusedBatchOfObservationsLeavesNothing) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  Observation more_inliers = Seen(2, 0, 10, 11);
  EXPECT_EQ(store_->AppendObservations("s", std::vector{Seen(1, 0), more_inliers}).code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(store_->AppendObservations("s", std::vector{Seen(1, 0), Seen(2, 3)}).code(),
            StatusCode::kNotFound);
  EXPECT_EQ(store_->AppendObservations("s", std::vector{Seen(0, 0)}).code(),
            StatusCode::kInvalidArgument);
  EXPECT_THAT(store_->ListObservations("s").value(), IsEmpty());
  EXPECT_EQ(
      store_->EndSession("s", SessionEnd::kByRobot, 1, std::vector{Seen(1, 9)}).status().code(),
      StatusCode::kNotFound);
  EXPECT_EQ(store_->GetSession("s")->end, SessionEnd::kOpen);
}

TEST_P(StoreContract, TheEndOfASessionChangesTheVisitedSegmentsAlone) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  ASSERT_TRUE(
      store_->AppendObservations("s", std::vector{Seen(1, 0, 40, 30), Missed(2, 0), Seen(3, 2)})
          .ok());
  EXPECT_EQ(At(key, 0).statistics.queries, 0);  // nothing before the end
  const std::int64_t before = Changes();
  const SessionSummary summary = End("s", {OutOfMap(4), Seen(5, 0, 60, 50)});
  EXPECT_GT(Changes(), before);

  EXPECT_EQ(summary.session, "s");
  EXPECT_EQ(summary.end, SessionEnd::kByRobot);
  EXPECT_EQ(summary.queries, 5);
  EXPECT_EQ(summary.localized, 3);
  using Change = SessionSummary::SegmentChange;
  EXPECT_THAT(summary.segments, ElementsAre(Change{0, 3, 2, Strategy::kMixed, Strategy::kMixed},
                                            Change{2, 1, 1, Strategy::kMixed, Strategy::kMixed}));
  const SegmentStatistics visited = At(key, 0).statistics;
  EXPECT_EQ(visited.sessions, 1);
  EXPECT_EQ(visited.queries, 3);
  EXPECT_EQ(visited.localized, 2);
  EXPECT_EQ(visited.point_matches, 100.0);
  EXPECT_EQ(visited.point_inliers, 80.0);
  EXPECT_EQ(visited.typical_point_matches, 50.0);
  EXPECT_EQ(At(key, 1).statistics, SegmentStatistics{});
  EXPECT_EQ(At(key, 1).decision.source, StrategySource::kDefault);
  EXPECT_THAT(store_->ListDecisions(key, 1).value(), IsEmpty());
  EXPECT_EQ(store_->GetSession("s")->end, SessionEnd::kByRobot);
  EXPECT_EQ(store_->GetSession("s")->end_unix_ns, 5000);
  EXPECT_TRUE(store_->Verify().ok()) << store_->Verify().ToString();
}

TEST_P(StoreContract, ASecondEndChangesNothingAndAnswersTheSame) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  const SessionSummary first = End("s", {Seen(1, 0)});
  const SegmentStatistics statistics = At(key, 0).statistics;
  const std::int64_t changes = Changes();
  const auto again = store_->EndSession("s", SessionEnd::kIdle, 9999, std::vector{Seen(2, 1)});
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(*again, first);
  EXPECT_EQ(At(key, 0).statistics, statistics);
  EXPECT_EQ(At(key, 1).statistics.queries, 0);
  EXPECT_EQ(Changes(), changes);
  EXPECT_EQ(store_->GetSession("s")->end_unix_ns, 5000);
  EXPECT_EQ(store_->AppendObservations("s", std::vector{Seen(2, 1)}).reason(), "SESSION_CLOSED");
  EXPECT_EQ(store_->EndSession("s", SessionEnd::kOpen, 1, {}).status().code(),
            StatusCode::kInvalidArgument);
}

TEST_P(StoreContract, AQuerySentTwiceCountsOnce) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  ASSERT_TRUE(store_->AppendObservations("s", std::vector{Seen(1, 0), Seen(2, 0)}).ok());
  const SessionSummary summary = End("s", {Seen(2, 0), Seen(3, 0)});
  EXPECT_EQ(summary.queries, 3);
  EXPECT_EQ(At(key, 0).statistics.queries, 3);
}

TEST_P(StoreContract, AnEmptySessionEndsWithoutATrace) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  const SessionSummary summary = End("s");
  EXPECT_EQ(summary.queries, 0);
  EXPECT_THAT(summary.segments, IsEmpty());
  EXPECT_EQ(At(key, 0).statistics, SegmentStatistics{});
}

// A session that started earlier but ends later takes its place by its start.
TEST_P(StoreContract, RowsFoldInTheOrderOfTheirStarts) {
  const MapKey key = GiveMap(*store_);
  Start("late", key, 3000);
  Start("early", key, 1000);
  Start("also_late", key, 3000);
  End("late", {Seen(1, 0, 50, 40)});
  End("early", {Seen(1, 0, 50, 10)});
  End("also_late", {Seen(1, 0, 50, 30)});
  const auto rows = store_->ListRows(key, 0).value();
  ASSERT_THAT(rows, SizeIs(3));
  EXPECT_EQ(rows[0].session, "early");
  EXPECT_EQ(rows[1].session, "also_late");
  EXPECT_EQ(rows[2].session, "late");
  EXPECT_EQ(rows[0].point_inliers, 10);
  EXPECT_EQ(At(key, 0).statistics, Aggregate(rows));
  EXPECT_EQ(At(key, 0).decision, SelectStrategy(rows));
  EXPECT_THAT(store_->ListDecisions(key, 0).value(), SizeIs(3));
}

TEST_P(StoreContract, EvidenceChangesTheStrategyAndTheSummarySaysSo) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  std::vector<Observation> good_lines;
  for (int i = 1; i <= 20; ++i) good_lines.push_back(Seen(i, 1, 100, 20, 20, 16));
  const SessionSummary summary = End("s", good_lines);
  ASSERT_THAT(summary.segments, SizeIs(1));
  EXPECT_EQ(summary.segments[0].strategy_before, Strategy::kMixed);
  EXPECT_EQ(summary.segments[0].strategy_after, Strategy::k1P1L);
  const SegmentSummary segment = At(key, 1);
  EXPECT_EQ(segment.decision.strategy, Strategy::k1P1L);
  EXPECT_EQ(segment.decision.source, StrategySource::kLearned);
  EXPECT_GT(segment.decision.predicted_success, 0.0);
  const auto history = store_->ListDecisions(key, 1).value();
  ASSERT_THAT(history, SizeIs(1));
  EXPECT_EQ(history[0].cause, "s");
  EXPECT_EQ(history[0].decision, segment.decision);
  EXPECT_EQ(history[0].statistics, segment.statistics);
}

TEST_P(StoreContract, APinHoldsAgainstTheSelectorUntilItIsTakenBack) {
  const MapKey key = GiveMap(*store_);
  const std::int64_t before = Changes();
  ASSERT_TRUE(store_->PinStrategy(key, 1, Strategy::k2P).ok());
  EXPECT_GT(Changes(), before);
  EXPECT_EQ(At(key, 1).decision.strategy, Strategy::k2P);
  EXPECT_EQ(At(key, 1).decision.source, StrategySource::kPinned);
  EXPECT_EQ(At(key, 0).decision.source, StrategySource::kDefault);
  Start("s", key);
  std::vector<Observation> good_lines;
  for (int i = 1; i <= 20; ++i) good_lines.push_back(Seen(i, 1, 100, 20, 20, 16));
  End("s", good_lines);
  EXPECT_EQ(At(key, 1).decision.strategy, Strategy::k2P);
  EXPECT_EQ(At(key, 1).pinned, Strategy::k2P);
  EXPECT_TRUE(store_->Verify().ok());
  ASSERT_TRUE(store_->PinStrategy(key, 1, std::nullopt).ok());
  EXPECT_EQ(At(key, 1).decision.strategy, Strategy::k1P1L);
  EXPECT_EQ(At(key, 1).decision.source, StrategySource::kLearned);
  EXPECT_EQ(store_->PinStrategy(key, 1, Strategy::kP3P).code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(store_->Verify().ok());
}

TEST_P(StoreContract, ManyRobotsAtOnceLoseNothing) {
  const MapKey key = GiveMap(*store_);
  constexpr int kRobots = 4;
  constexpr int kQueries = 12;
  for (int robot = 0; robot < kRobots; ++robot) Start(std::to_string(robot), key, robot);
  std::atomic<int> failures = 0;
  const auto drive = [&](int robot) {
    const SessionId id = std::to_string(robot);
    for (int i = 1; i <= kQueries; ++i) {
      failures += !store_->AppendObservations(id, std::vector{Seen(i, i % 3)}).ok();
      failures += !store_->ListSegments(key).ok();
    }
    failures += !store_->EndSession(id, SessionEnd::kByRobot, 9, {}).ok();
  };
  std::vector<std::thread> robots;
  for (int robot = 0; robot < kRobots; ++robot) robots.emplace_back(drive, robot);
  for (std::thread& robot : robots) robot.join();
  EXPECT_EQ(failures, 0);
  for (SegmentId id = 0; id < 3; ++id) {
    EXPECT_EQ(At(key, id).statistics.queries, kRobots * kQueries / 3);
    EXPECT_EQ(At(key, id).statistics.sessions, kRobots);
  }
  EXPECT_TRUE(store_->Verify().ok());
}

// Two threads end one session at once: one folds it, both get the same answer.
TEST_P(StoreContract, ASessionEndedTwiceAtOnceCountsOnce) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  ASSERT_TRUE(store_->AppendObservations("s", std::vector{Seen(1, 0), Seen(2, 1)}).ok());
  SessionSummary answers[2];
  std::thread other([&] { answers[1] = End("s"); });
  answers[0] = End("s");
  other.join();
  EXPECT_EQ(answers[0], answers[1]);
  EXPECT_EQ(At(key, 0).statistics.queries, 1);
}

TEST_P(PersistentStoreContract, ARestartForgetsNothing) {
  const MapKey key = GiveMap(*store_);
  Start("ended", key);
  Start("open", key, 2000);
  ASSERT_TRUE(store_->AppendObservations("open", std::vector{Seen(1, 1)}).ok());
  std::vector<Observation> seen;
  for (int i = 1; i <= 15; ++i) seen.push_back(Seen(i, 0, 90 + i, 33, 21, 7));
  const SessionSummary summary = End("ended", seen);
  ASSERT_TRUE(store_->PinStrategy(key, 2, Strategy::k1P1L).ok());
  const SegmentSummary before = At(key, 0);
  const auto history = store_->ListDecisions(key, 0).value();
  const std::int64_t changes = Changes();

  Open();
  const SegmentSummary after = At(key, 0);
  EXPECT_EQ(after.statistics, before.statistics);
  EXPECT_EQ(after.decision, before.decision);
  EXPECT_EQ(after.selector, before.selector);
  EXPECT_EQ(store_->ListDecisions(key, 0).value(), history);
  EXPECT_EQ(At(key, 2).pinned, Strategy::k1P1L);
  EXPECT_EQ(Changes(), changes);
  EXPECT_EQ(End("ended"), summary);
  EXPECT_EQ(End("open").queries, 1);
  EXPECT_TRUE(store_->Verify().ok()) << store_->Verify().ToString();
}

}  // namespace
}  // namespace maploc::testing
