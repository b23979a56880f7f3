#include "tests/experiments/selection/leave_one_out.h"

#include <cmath>

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

// Of so many numbers, from their own spread. The bootstrap's own ends are off by some 4% of it.
double HalfWidthOfTheMean95(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  return 1.96 * std::sqrt((squares / count - sum / count * sum / count) / count);
}

TEST(LeaveOneOutTest, IntervalIsThatOfTheMeanDifferenceAndTheSameEachTime) {
  // Query by query the selected method is better by another amount; now and then it is the worse.
  const int other = AutoMethodOf(Strategy::kMixed);
  std::vector<QueryResult> results;
  std::vector<double> differences;
  for (int i = 0; i < 50; ++i) {
    QueryResult& query = results.emplace_back(Localized(kHouses, 50, 20, i + 1));
    MethodResult& of_other = query.methods[other];
    of_other.errors = {PoseError{.translation_m = 0.1 * (1 + i % 10), .rotation_deg = 0.0}};
    of_other.credit = AreaUnderCurve(of_other.errors);
    differences.push_back(query.methods[AutoMethodOf(Strategy::k1P1L)].credit - of_other.credit);
  }
  std::vector<ScoredQuery> queries;
  for (const QueryResult& result : results) {
    queries.push_back({&result, AutoMethodOf(Strategy::k1P1L)});
  }
  const Interval interval = BootstrapSelection(queries, other, 7);
  const double difference = ScoreOf(queries, kSelection).auc - ScoreOf(queries, other).auc;
  EXPECT_LT(interval.low, difference);
  EXPECT_GT(interval.high, difference);
  const double half = HalfWidthOfTheMean95(differences);
  EXPECT_NEAR(interval.low, difference - half, 0.2 * half);
  EXPECT_NEAR(interval.high, difference + half, 0.2 * half);
  const Interval again = BootstrapSelection(queries, other, 7);
  EXPECT_EQ(again.low, interval.low);
  EXPECT_EQ(again.high, interval.high);
}

TEST(LeaveOneOutTest, UnansweredCountsAsFailed) {
  QueryResult query = Localized(kHouses, 50, 20, 1);
  const int method = AutoMethodOf(Strategy::k2P);
  query.methods[method].errors = {std::nullopt, PoseError{0.0, 0.0}};
  EXPECT_DOUBLE_EQ(ScoreOf({{&query, method}}, method).auc, 0.5);
}

}  // namespace
}  // namespace maploc::selection
