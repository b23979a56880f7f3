#include "mapstore/statistics/change.h"

#include <string>

#include <gmock/gmock.h>

namespace maploc {
namespace {

struct Level {
  double points = 0.6;
  double lines = 0.3;
  int localized = 40;  // of 40
};

SegmentSessionRow Row(int start, const Level& level) {
  SegmentSessionRow row;
  row.session = "s" + std::to_string(100 + start);
  row.session_start_unix_ns = start;
  row.queries = 40;
  row.localized = level.localized;
  row.point_matches = level.localized * 100;
  row.point_inliers = static_cast<std::int64_t>(level.localized * 100 * level.points);
  row.usable_line_matches = level.localized * 40;
  row.usable_line_inliers = static_cast<std::int64_t>(level.localized * 40 * level.lines);
  row.vertical_line_matches = level.localized * 10;
  row.vertical_line_inliers = static_cast<std::int64_t>(level.localized * 10 * level.lines);
  return row;
}

// Sessions of each level, one after the other.
std::vector<SegmentSessionRow> Rows(const std::vector<std::pair<int, Level>>& levels) {
  std::vector<SegmentSessionRow> rows;
  for (const auto& [sessions, level] : levels) {
    for (int i = 0; i < sessions; ++i) rows.push_back(Row(static_cast<int>(rows.size()), level));
  }
  return rows;
}

TEST(FindChanges, OfASteadySegmentAreNone) {
  EXPECT_TRUE(FindChanges({}).empty());
  EXPECT_TRUE(FindChanges(Rows({{1, {}}})).empty());
  EXPECT_TRUE(FindChanges(Rows({{30, {}}})).empty());
  // Every other session a little better: scatter, no change.
  std::vector<SegmentSessionRow> rows;
  for (int i = 0; i < 30; ++i) rows.push_back(Row(i, {i % 2 == 0 ? 0.55 : 0.65, 0.3, 40}));
  EXPECT_TRUE(FindChanges(rows).empty());
}

TEST(FindChanges, TellSinceWhenAndInWhat) {
  const auto changes = FindChanges(Rows({{12, {}}, {5, {0.2, 0.3, 40}}}));
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].kind, ChangeKind::kPoints);
  EXPECT_EQ(changes[0].since, "s112");
  EXPECT_EQ(changes[0].since_unix_ns, 12);
  EXPECT_EQ(changes[0].sessions, 5);
  EXPECT_DOUBLE_EQ(changes[0].before, 0.6);
  EXPECT_DOUBLE_EQ(changes[0].after, 0.2);
  EXPECT_LT(changes[0].deviation, -4.0);

  const auto lines = FindChanges(Rows({{12, {}}, {5, {0.6, 0.8, 40}}}));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].kind, ChangeKind::kLines);
  EXPECT_GT(lines[0].deviation, 4.0);

  const auto success = FindChanges(Rows({{12, {}}, {5, {0.6, 0.3, 4}}}));
  ASSERT_EQ(success.size(), 1u);
  EXPECT_EQ(success[0].kind, ChangeKind::kSuccess);
  EXPECT_DOUBLE_EQ(success[0].after, 0.1);
}

// A session without an answer has no ratio, but it has a share of answers.
TEST(FindChanges, KnowSegmentsWhereNothingIsFoundAnyMore) {
  const auto changes = FindChanges(Rows({{10, {}}, {4, {0.6, 0.3, 0}}}));
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].kind, ChangeKind::kSuccess);
  EXPECT_EQ(changes[0].since, "s110");
  EXPECT_EQ(changes[0].after, 0.0);
}

TEST(FindChanges, TellTheLastOfSeveral) {
  const Level autumn = {0.05, 0.3, 40};
  const auto changes = FindChanges(Rows({{15, {}}, {10, autumn}, {3, {}}}));
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].since, "s125");
  EXPECT_DOUBLE_EQ(changes[0].before, 0.05);
  EXPECT_DOUBLE_EQ(changes[0].after, 0.6);
}

TEST(FindChanges, NeedMoreThanAFewQueries) {
  auto rows = Rows({{10, {}}});
  SegmentSessionRow odd = Row(10, {0.2, 0.3, 1});
  odd.queries = 1;
  rows.push_back(odd);
  EXPECT_TRUE(FindChanges(rows).empty());
}

}  // namespace
}  // namespace maploc
