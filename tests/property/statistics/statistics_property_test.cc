// What holds for every history: order-free folding, a replay that equals the whole, probabilities
// that agree with drawing.
#include <algorithm>

#include <gtest/gtest.h>

#include "mapstore/statistics/selector.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using testing::TestRandom;

FeatureCounts RandomCounts(Random& random, std::uint32_t most) {
  FeatureCounts counts;
  counts.matches = static_cast<std::int32_t>(random.Below(most));
  counts.inliers = static_cast<std::int32_t>(random.Below(counts.matches + 1));
  return counts;
}

std::vector<Observation> RandomObservations(Random& random, int count) {
  std::vector<Observation> observations;
  for (int i = 1; i <= count; ++i) {
    Observation observation;
    observation.sequence = i;
    observation.segment = static_cast<SegmentId>(random.Below(4)) - 1;
    observation.outcome = random.Below(3) == 0 ? Outcome::kNoConsensus : Outcome::kLocalized;
    observation.evidence.points = RandomCounts(random, 200);
    observation.evidence.usable_lines = RandomCounts(random, 50);
    observation.evidence.vertical_lines = RandomCounts(random, 20);
    observations.push_back(observation);
  }
  return observations;
}

void Shuffle(std::vector<Observation>& observations, Random& random) {
  for (std::size_t i = observations.size(); i > 1; --i) {
    std::swap(observations[i - 1], observations[random.Below(static_cast<std::uint32_t>(i))]);
  }
}

std::vector<SegmentSessionRow> RandomRows(Random& random, int count) {
  std::vector<SegmentSessionRow> rows;
  for (int i = 0; i < count; ++i) {
    Session session;
    session.id = "s" + std::to_string(100 + i);
    session.start_unix_ns = i;
    auto observations = RandomObservations(random, 1 + static_cast<int>(random.Below(20)));
    for (Observation& observation : observations) observation.segment = 0;
    rows.push_back(FoldObservations(session, observations).front());
  }
  return rows;
}

TEST(Statistics, TheOrderOfQueriesDoesNotMatter) {
  for (int repetition = 0; repetition < 50; ++repetition) {
    Random random = TestRandom(repetition);
    Session session;
    session.id = "s";
    std::vector<Observation> observations = RandomObservations(random, 40);
    const auto rows = FoldObservations(session, observations);
    Shuffle(observations, random);
    EXPECT_EQ(FoldObservations(session, observations), rows) << "repetition " << repetition;
  }
}

TEST(Statistics, EveryQueryCountsInOneRow) {
  Random random = TestRandom();
  const auto observations = RandomObservations(random, 200);
  std::int64_t counted = 0;
  for (const auto& row : FoldObservations(Session{}, observations)) counted += row.queries;
  const auto in_map = std::count_if(observations.begin(), observations.end(),
                                    [](const Observation& o) { return o.segment >= 0; });
  EXPECT_EQ(counted, in_map);
}

// The fold that the selector replays gives at each step what the rows so far give by themselves.
TEST(Statistics, TheReplayEqualsTheWholeAtEveryStep) {
  Random random = TestRandom();
  const std::vector<SegmentSessionRow> rows = RandomRows(random, 30);
  StatisticsFold fold({});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    fold.Add(rows[i]);
    EXPECT_EQ(fold.Value(), Aggregate(std::span(rows).first(i + 1)));
  }
}

TEST(Statistics, TheSelectorsReplayEqualsTheWholeAtEveryStep) {
  Random random = TestRandom();
  const std::vector<SegmentSessionRow> rows = RandomRows(random, 30);
  SelectorFold fold({});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    fold.Add(rows[i]);
    EXPECT_EQ(fold.Decision(), SelectStrategy(std::span(rows).first(i + 1)));
  }
}

TEST(Statistics, RatiosAndProbabilitiesStayWithinTheirBounds) {
  for (int repetition = 0; repetition < 200; ++repetition) {
    Random random = TestRandom(repetition);
    const double p = static_cast<double>(random.Below(30)) / 2.0;
    const double l = static_cast<double>(random.Below(30)) / 2.0;
    const double lambda = random.Uniform();
    const double gamma = random.Uniform();
    const StrategyValues draw = DrawProbabilities({p, l, 0.0}, {lambda, gamma, 0.0});
    for (const double probability : {draw.p1p1l, draw.p2p, draw.mixed}) {
      EXPECT_GE(probability, 0.0);
      EXPECT_LE(probability, 1.0);
    }
    if (p < 2.0 || l < 1.0 || lambda * p < 1.0) continue;
    // gamma >= lambda - a, a = (1 - lambda) / (p - 1), puts mixed between the other two.
    const bool lines_better = gamma >= lambda - (1.0 - lambda) / (p - 1.0);
    const double best = lines_better ? draw.p1p1l : draw.p2p;
    const double worst = lines_better ? draw.p2p : draw.p1p1l;
    EXPECT_GE(best + 1e-12, draw.mixed);
    EXPECT_GE(draw.mixed + 1e-12, worst);
  }
}

}  // namespace
}  // namespace maploc
