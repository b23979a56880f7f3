#include "tests/experiments/selection/leave_one_out.h"

#include <gtest/gtest.h>

namespace maploc::selection {
namespace {

// A localized query: of 100 points and 40 usable lines so many are inliers. Every method was off by
// its own index in decimetres.
QueryResult Localized(SegmentId segment, int point_inliers, int line_inliers, int sequence) {
  QueryResult query;
  query.segment = segment;
  for (int i = 0; i < kMethodCount; ++i) {
    query.methods[i].errors = {PoseError{.translation_m = 0.1 * (i + 1), .rotation_deg = 0.0}};
    query.methods[i].credit = AreaUnderCurve(query.methods[i].errors);
  }
  query.observation.sequence = sequence;
  query.observation.segment = segment;
  query.observation.outcome = Outcome::kLocalized;
  query.observation.evidence.points = {.matches = 100, .inliers = point_inliers};
  query.observation.evidence.usable_lines = {.matches = 40, .inliers = line_inliers};
  return query;
}

constexpr SegmentId kHouses = 0;
constexpr SegmentId kTrees = 1;
constexpr SegmentId kUnknown = 2;

SessionResult Session(const std::string& name, int houses_points, int houses_lines) {
  SessionResult session{name, {}};
  for (int i = 0; i < 20; ++i) {
    session.queries.push_back(Localized(kHouses, houses_points, houses_lines, 2 * i + 1));
    session.queries.push_back(Localized(kTrees, 60, 1, 2 * i + 2));
  }
  return session;
}

int SelectedIn(const LeftOut& left_out, const SessionResult& session, SegmentId segment) {
  for (std::size_t i = 0; i < session.queries.size(); ++i) {
    if (session.queries[i].segment == segment) return left_out.selected[i];
  }
  return -1;
}

TEST(LeaveOneOutTest, OthersTeachAndTheOneLeftOutDoesNot) {
  // The last session saw along the houses the opposite of what all others saw.
  std::vector<SessionResult> sessions = {Session("a", 10, 30), Session("b", 10, 30),
                                         Session("c", 10, 30), Session("d", 90, 1)};
  sessions.back().queries.push_back(Localized(kUnknown, 90, 1, 99));
  const std::vector<LeftOut> all = LeaveEachOut(sessions, {});
  ASSERT_EQ(all.size(), sessions.size());
  EXPECT_EQ(SelectedIn(all[3], sessions[3], kHouses), AutoMethodOf(Strategy::k1P1L));
  EXPECT_NE(SelectedIn(all[3], sessions[3], kTrees), AutoMethodOf(Strategy::k1P1L));
  EXPECT_EQ(SelectedIn(all[3], sessions[3], kUnknown), AutoMethodOf(Strategy::kMixed));
  EXPECT_FALSE(all[3].segments.contains(kUnknown));
}

TEST(LeaveOneOutTest, SelectionsScoreIsThatOfWhatWasSelected) {
  const QueryResult query = Localized(kHouses, 50, 20, 1);
  for (const Strategy strategy : kStrategies) {
    const int selected = AutoMethodOf(strategy);
    const std::vector<ScoredQuery> queries = {{&query, selected}};
    EXPECT_EQ(ScoreOf(queries, kSelection).auc, ScoreOf(queries, selected).auc);
    EXPECT_EQ(ScoreOf(queries, selected).recall[3], 1.0);
  }
}

TEST(LeaveOneOutTest, IntervalHoldsTheDifferenceAndIsTheSameEachTime) {
  std::vector<QueryResult> results;
  for (int i = 0; i < 50; ++i) results.push_back(Localized(kHouses, 50, 20, i + 1));
  std::vector<ScoredQuery> queries;
  for (const QueryResult& result : results) {
    queries.push_back({&result, AutoMethodOf(Strategy::k1P1L)});
  }
  const int other = AutoMethodOf(Strategy::kMixed);
  const Interval interval = BootstrapSelection(queries, other, 7);
  const double difference = ScoreOf(queries, kSelection).auc - ScoreOf(queries, other).auc;
  EXPECT_GT(difference, 0.0);  // a smaller error by construction
  EXPECT_LE(interval.low, difference + 1e-12);
  EXPECT_GE(interval.high, difference - 1e-12);
  EXPECT_EQ(BootstrapSelection(queries, other, 7).low, interval.low);
}

TEST(LeaveOneOutTest, UnansweredCountsAsFailed) {
  QueryResult query = Localized(kHouses, 50, 20, 1);
  const int method = AutoMethodOf(Strategy::k2P);
  query.methods[method].errors = {std::nullopt, PoseError{0.0, 0.0}};
  EXPECT_DOUBLE_EQ(ScoreOf({{&query, method}}, method).auc, 0.5);
}

}  // namespace
}  // namespace maploc::selection
