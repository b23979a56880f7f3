// What a segment still knows of its past: sessions that differ as days do must not make it forget,
// and a true change must.
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "mapstore/statistics/statistics.h"
#include "tests/property/statistics/season.h"
#include "tests/support/seed.h"

namespace maploc::testing {
namespace {

constexpr int kSegments = 100;
constexpr int kSessions = 100;

// The relative standard deviation of a session's inlier ratios, and its queries.
class Memory : public ::testing::TestWithParam<std::tuple<double, int>> {
 protected:
  Robots ServedRobots() const {
    Robots robots;
    robots.session_noise = std::get<0>(GetParam());
    robots.queries = std::get<1>(GetParam());
    robots.max_iterations = 10000;
    robots.fall_back = true;
    return robots;
  }
};

// At least 80% of the weight that age alone leaves, and at most 3% of the sessions taken for a
// change. `explain` names at most 3% of the segments as changed after a hundred sessions.
TEST_P(Memory, OfASteadySegmentIsKept) {
  StatisticsOptions by_age;
  by_age.change_discount = 1.0;
  Random random = TestRandom();
  double kept = 0.0;
  int changes = 0;
  int changed_segments = 0;
  for (int segment = 0; segment < kSegments; ++segment) {
    StatisticsFold fold({});
    StatisticsFold aged(by_age);
    std::vector<SegmentSessionRow> rows;
    for (int i = 0; i < kSessions; ++i) {
      rows.push_back(RunSession(i, Season{}, ServedRobots(), {}, random));
      const double half_of_before = 0.5 * fold.Value().weighted_queries;
      fold.Add(rows.back());
      aged.Add(rows.back());
      kept += fold.Value().weighted_queries / aged.Value().weighted_queries;
      const double old = fold.Value().weighted_queries - ServedRobots().queries;
      changes += old < half_of_before ? 1 : 0;
    }
    changed_segments += FindChanges(rows).empty() ? 0 : 1;
  }
  EXPECT_GE(kept, 0.8 * kSegments * kSessions);
  EXPECT_LE(changes, 0.03 * kSegments * kSessions);
  EXPECT_LE(changed_segments, 0.03 * kSegments);
  RecordProperty("kept_percent", static_cast<int>(100.0 * kept / (kSegments * kSessions)));
  RecordProperty("changes", changes);
  RecordProperty("changed_segments", changed_segments);
}

// The share of right points falls from 60% to 5%: the old sessions lose their weight.
TEST_P(Memory, OfBeforeAChangeIsLostWithinThreeSessions) {
  Random random = TestRandom();
  int followed = 0;
  for (int segment = 0; segment < kSegments; ++segment) {
    StatisticsFold fold({});
    for (int i = 0; i < 20; ++i) fold.Add(RunSession(i, Season{}, ServedRobots(), {}, random));
    for (int i = 20; i < 23; ++i) {
      fold.Add(RunSession(i, {0.05, 0.3}, ServedRobots(), {}, random));
    }
    followed += *fold.Value().PointInlierRatio() < 0.15 ? 1 : 0;
  }
  EXPECT_GE(followed, kSegments * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(Sessions, Memory,
                         ::testing::Combine(::testing::Values(0.0, 0.1, 0.2),
                                            ::testing::Values(8, 40)));

}  // namespace
}  // namespace maploc::testing
