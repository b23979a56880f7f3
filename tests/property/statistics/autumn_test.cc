// An autumn: the leaves fall, and with them the point inlier ratio of a segment, from 60% to 5%;
// its lines stay at 30%. In spring they are back.
#include <iostream>

#include <gmock/gmock.h>

#include "mapstore/statistics/explain.h"
#include "tests/property/statistics/season.h"
#include "tests/support/seed.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;

constexpr Season kSummer = {0.6, 0.3};
constexpr Season kAutumn = {0.05, 0.3};
constexpr int kSeeds = 100;
constexpr int kSessionsToFollow = 3;
constexpr int kNoisySessions = 20;

// A segment in use: each session runs under the decision of those before.
class Year {
 public:
  Year(const Robots& robots, const SelectorOptions& options, Random random)
      : robots_(robots), options_(options), random_(random) {}

  void Run(const Season& season, int sessions) {
    for (int i = 0; i < sessions; ++i) {
      rows_.push_back(
          RunSession(static_cast<int>(rows_.size()), season, robots_, decision_, random_));
      decision_ = SelectStrategy(rows_, options_);
      strategies_.push_back(decision_.strategy);
    }
  }
  Strategy strategy() const { return decision_.strategy; }
  // In force after each of the last `sessions`.
  int ChangesInLast(int sessions) const {
    int changes = 0;
    for (std::size_t i = strategies_.size() - static_cast<std::size_t>(sessions);
         i < strategies_.size(); ++i) {
      changes += strategies_[i] != strategies_[i - 1] ? 1 : 0;
    }
    return changes;
  }
  Explanation Explain() const { return ExplainStrategy(rows_, decision_, options_); }

 private:
  Robots robots_;
  SelectorOptions options_;
  Random random_;
  std::vector<SegmentSessionRow> rows_;
  std::vector<Strategy> strategies_;
  StrategyDecision decision_;
};

// Robots that give up early, without fallback: in autumn most queries of 2P fail, and those that
// do not are the lucky ones. And robots as the server serves them.
struct Case {
  std::string name;
  Robots robots;
};

class Autumn : public ::testing::TestWithParam<Case> {
 protected:
  SelectorOptions Options() const {
    SelectorOptions options;
    options.max_iterations = GetParam().robots.max_iterations;
    return options;
  }
};

TEST_P(Autumn, IsFollowedWithinThreeSessionsWithoutFlappingAndBackInSpring) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    Year year(GetParam().robots, Options(), TestRandom(seed));
    year.Run(kSummer, 15);
    const Strategy in_summer = year.strategy();
    ASSERT_EQ(in_summer, Strategy::k2P) << ExplanationText(year.Explain());
    year.Run(kAutumn, kSessionsToFollow);
    ASSERT_EQ(year.strategy(), Strategy::k1P1L) << ExplanationText(year.Explain());
    year.Run(kAutumn, kNoisySessions);
    ASSERT_EQ(year.ChangesInLast(kNoisySessions), 0) << ExplanationText(year.Explain());
    year.Run(kSummer, kSessionsToFollow);
    ASSERT_EQ(year.strategy(), in_summer) << ExplanationText(year.Explain());
    year.Run(kSummer, kNoisySessions);
    ASSERT_EQ(year.ChangesInLast(kNoisySessions), 0) << ExplanationText(year.Explain());
  }
}

// What `explain` says at each change: the numbers that made it, and the change in the map.
TEST_P(Autumn, IsExplained) {
  Year year(GetParam().robots, Options(), TestRandom());
  year.Run(kSummer, 15);
  year.Run(kAutumn, kSessionsToFollow);
  const Explanation autumn = year.Explain();
  const std::string text = ExplanationText(autumn);
  std::cout << "--- autumn, " << GetParam().name << "\n" << text;
  ASSERT_EQ(autumn.decision.strategy, Strategy::k1P1L);
  EXPECT_THAT(text, HasSubstr("Uses 1p1l (learned)"));
  EXPECT_THAT(text, HasSubstr("-> 1p1l"));
  EXPECT_THAT(text, HasSubstr("points fell from 0."));
  EXPECT_LT(autumn.points.credible_95.high, 0.2);
  EXPECT_GT(autumn.usable_lines.credible_95.low, 0.2);
  EXPECT_LT(autumn.prediction.p1p1l.expected_time, 0.85 * autumn.prediction.p2p.expected_time);
  ASSERT_FALSE(autumn.changes.empty());
  EXPECT_EQ(autumn.changes[0].kind, ChangeKind::kPoints);
  EXPECT_EQ(autumn.changes[0].since, "s1015");
  EXPECT_NEAR(autumn.changes[0].before, 0.6, 0.06);
  EXPECT_LT(autumn.changes[0].after, 0.1);

  year.Run(kAutumn, kNoisySessions);
  year.Run(kSummer, kSessionsToFollow);
  const Explanation spring = year.Explain();
  std::cout << "--- spring, " << GetParam().name << "\n" << ExplanationText(spring);
  EXPECT_THAT(ExplanationText(spring), HasSubstr("points rose from 0.0"));
  EXPECT_THAT(ExplanationText(spring), HasSubstr("-> 2p. 2p instead of"));
  ASSERT_FALSE(spring.changes.empty());
  EXPECT_EQ(spring.changes[0].since, "s1038");
}

std::vector<Case> Cases() {
  Robots hasty;
  Robots served;
  served.max_iterations = 10000;
  served.fall_back = true;
  return {{"Hasty", hasty}, {"Served", served}};
}

INSTANTIATE_TEST_SUITE_P(Robots, Autumn, ::testing::ValuesIn(Cases()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace maploc::testing
