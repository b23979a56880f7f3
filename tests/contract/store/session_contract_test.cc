// What every store promises of sessions, statistics and strategies (mapstore/store/map_store.h).
#include <atomic>
#include <thread>

#include <gmock/gmock.h>

#include "tests/contract/load/many_robots.h"
#include "tests/contract/store/store_contract.h"

namespace maploc::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class SessionContract : public StoreContract {};
INSTANTIATE_TEST_SUITE_P(Stores, SessionContract,
                         ::testing::Values(StoreKind::kInMemory, StoreKind::kSqlite), NameOf);

// Promises of a store that outlives its process.
class PersistentStoreContract : public StoreContract {};
INSTANTIATE_TEST_SUITE_P(Stores, PersistentStoreContract, ::testing::Values(StoreKind::kSqlite),
                         NameOf);

TEST_P(SessionContract, ASessionComesBackAsItStarted) {
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

TEST_P(SessionContract, AnObservationIsKeptOnceAndWhole) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  std::vector<Observation> both = {Seen(1, 0), OutOfMap(2)};
  both[0].evidence.focal_scale = FocalScale{1.1, 0.01};
  ASSERT_TRUE(Append(*store_, "s", both).ok());
  ASSERT_TRUE(Append(*store_, "s", both).ok());
  ASSERT_TRUE(Append(*store_, "s", std::vector{Seen(1, 2, 7, 7)}).ok());
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
  EXPECT_EQ(kept[0].evidence.inlier_rms_px, want.evidence.inlier_rms_px);
  EXPECT_EQ(kept[0].evidence.gravity_rejected, want.evidence.gravity_rejected);
  EXPECT_FALSE(kept[0].evidence.focal_scale.has_value()) << "the only thing that is not kept";
  EXPECT_EQ(kept[0].total_ms, want.total_ms);
  EXPECT_EQ(kept[0].time_unix_ns, want.time_unix_ns);
  EXPECT_EQ(kept[1].outcome, Outcome::kOutOfMap);
  EXPECT_EQ(kept[1].segment, -1);
}

Observation Named(const std::string& counted_as, std::int64_t sequence) {
  Observation observation = Seen(sequence, 0);
  observation.counted_as = counted_as;
  return observation;
}

TEST_P(SessionContract, AQueryThatWasAnsweredTwiceCountsOnce) {
  const MapKey key = GiveMap(*store_);
  for (const char* id : {"a", "b"}) Start(id, key);
  ASSERT_TRUE(Append(*store_, "a", {Named("q", 1), Named("q", 2), Named("other", 3)}).ok());
  ASSERT_TRUE(Append(*store_, "a", {Named("q", 4), Named("", 5), Named("", 6)}).ok());
  ASSERT_TRUE(Append(*store_, "b", {Named("q", 1)}).ok());
  const auto kept = store_->ListObservations("a").value();
  ASSERT_THAT(kept, SizeIs(4));
  EXPECT_EQ(kept[0].sequence, 1);
  EXPECT_EQ(kept[0].counted_as, "q");
  EXPECT_EQ(End("a", {Named("q", 7), Named("other", 8), Named("late", 9)}).queries, 5);
  EXPECT_EQ(End("b").queries, 1);
  EXPECT_TRUE(store_->Verify().ok()) << store_->Verify().ToString();
}

TEST_P(SessionContract, EveryOutcomeIsKeptAndOnlyOneIsLocalized) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  std::vector<Observation> observations;
  for (int outcome = 1; outcome <= 7; ++outcome) {
    observations.push_back(Seen(outcome, 0));
    observations.back().outcome = static_cast<Outcome>(outcome);
  }
  ASSERT_TRUE(Append(*store_, "s", observations).ok());
  const auto kept = store_->ListObservations("s").value();
  ASSERT_THAT(kept, SizeIs(7));
  EXPECT_EQ(kept[6].outcome, Outcome::kCalibrationInconsistent);
  const auto summary = store_->EndSession("s", SessionEnd::kByRobot, 9, {});
  ASSERT_TRUE(summary.ok()) << summary.status().ToString();
  EXPECT_EQ(summary->queries, 7);
  EXPECT_EQ(summary->localized, 1);
}

TEST_P(SessionContract, ARefusedBatchOfObservationsLeavesNothing) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  Observation more_inliers = Seen(2, 0, 10, 11);
  EXPECT_EQ(Append(*store_, "s", std::vector{Seen(1, 0), more_inliers}).code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(Append(*store_, "s", std::vector{Seen(1, 0), Seen(2, 3)}).code(),
            StatusCode::kNotFound);
  EXPECT_EQ(Append(*store_, "s", std::vector{Seen(0, 0)}).code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(store_->ListObservations("s").value(), IsEmpty());
  EXPECT_EQ(
      store_->EndSession("s", SessionEnd::kByRobot, 1, std::vector{Seen(1, 9)}).status().code(),
      StatusCode::kNotFound);
  EXPECT_EQ(store_->GetSession("s")->end, SessionEnd::kOpen);
}

TEST_P(SessionContract, AGroupOfSessionsIsAppendedTogetherOrNotAtAll) {
  const MapKey key = GiveMap(*store_);
  for (const char* id : {"a", "b", "ended"}) Start(id, key);
  ASSERT_TRUE(store_->EndSession("ended", SessionEnd::kByRobot, 1, {}).ok());

  EXPECT_EQ(
      store_
          ->AppendGroup(std::vector<SessionObservations>{{"a", {Seen(1, 0)}}, {"b", {Seen(1, 9)}}})
          .status()
          .code(),
      StatusCode::kNotFound);
  EXPECT_THAT(store_->ListObservations("a").value(), IsEmpty());

  const auto late =
      store_->AppendGroup(std::vector<SessionObservations>{{"a", {Seen(1, 0), Seen(2, 1)}},
                                                           {"ended", {Seen(1, 9)}},
                                                           {"b", {Seen(1, 2)}}});  // no segment 9
  ASSERT_TRUE(late.ok()) << late.status().ToString();
  EXPECT_THAT(*late, ElementsAre("ended"));
  EXPECT_THAT(store_->ListObservations("a").value(), SizeIs(2));
  EXPECT_THAT(store_->ListObservations("b").value(), SizeIs(1));
  EXPECT_THAT(store_->ListObservations("ended").value(), IsEmpty());
  EXPECT_EQ(store_->AppendGroup(std::vector<SessionObservations>{{"nobody", {}}}).status().code(),
            StatusCode::kNotFound);
}

TEST_P(SessionContract, TheEndOfASessionChangesTheVisitedSegmentsAlone) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  ASSERT_TRUE(Append(*store_, "s", std::vector{Seen(1, 0, 40, 30), Missed(2, 0), Seen(3, 2)}).ok());
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

TEST_P(SessionContract, ASecondEndChangesNothingAndAnswersTheSame) {
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
  EXPECT_THAT(store_->AppendGroup(std::vector<SessionObservations>{{"s", {Seen(2, 1)}}}).value(),
              ElementsAre("s"));
  EXPECT_EQ(store_->EndSession("s", SessionEnd::kOpen, 1, {}).status().code(),
            StatusCode::kInvalidArgument);
}

TEST_P(SessionContract, AQuerySentTwiceCountsOnce) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  ASSERT_TRUE(Append(*store_, "s", std::vector{Seen(1, 0), Seen(2, 0)}).ok());
  const SessionSummary summary = End("s", {Seen(2, 0), Seen(3, 0)});
  EXPECT_EQ(summary.queries, 3);
  EXPECT_EQ(At(key, 0).statistics.queries, 3);
}

TEST_P(SessionContract, AnEmptySessionEndsWithoutATrace) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  const SessionSummary summary = End("s");
  EXPECT_EQ(summary.queries, 0);
  EXPECT_THAT(summary.segments, IsEmpty());
  EXPECT_EQ(At(key, 0).statistics, SegmentStatistics{});
}

// A session that started earlier but ends later takes its place by its start.
TEST_P(SessionContract, RowsFoldInTheOrderOfTheirStarts) {
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

TEST_P(SessionContract, EvidenceChangesTheStrategyAndTheSummarySaysSo) {
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

TEST_P(SessionContract, APinHoldsAgainstTheSelectorUntilItIsTakenBack) {
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

TEST_P(SessionContract, ManyRobotsAtOnceLoseNothing) {
  const MapKey key = GiveMap(*store_);
  constexpr int kRobots = 4;
  constexpr int kQueries = 12;
  for (int robot = 0; robot < kRobots; ++robot) Start(std::to_string(robot), key, robot);
  std::atomic<int> failures = 0;
  const auto drive = [&](int robot) {
    const SessionId id = std::to_string(robot);
    for (int i = 1; i <= kQueries; ++i) {
      failures += !Append(*store_, id, std::vector{Seen(i, i % 3)}).ok();
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

// tests/contract/load has the whole 100,000.
TEST_P(SessionContract, ManyObservationsByManyRobotsAreAllCountedOnce) {
  const MapKey key = GiveMap(*store_);
  EXPECT_EQ(DriveRobots(*store_, key, 64, 110, 3), 0);
  ExpectAllCountedOnce(*store_, key, 64, 110, 3);
}

// Two threads end one session at once: one folds it, both get the same answer.
TEST_P(SessionContract, ASessionEndedTwiceAtOnceCountsOnce) {
  const MapKey key = GiveMap(*store_);
  Start("s", key);
  ASSERT_TRUE(Append(*store_, "s", std::vector{Seen(1, 0), Seen(2, 1)}).ok());
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
  ASSERT_TRUE(Append(*store_, "open", std::vector{Seen(1, 1)}).ok());
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
