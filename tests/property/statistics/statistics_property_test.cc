// What holds for every history: order-free folding, a replay that equals the whole, probabilities
// that agree with drawing.
#include <algorithm>
#include <cmath>

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
    session.id = "s" + std::to_string(i);
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

TEST(Statistics, RatiosAndProbabilitiesStayWithinTheirBounds) {
  for (int repetition = 0; repetition < 200; ++repetition) {
    Random random = TestRandom(repetition);
    const double p = static_cast<double>(random.Below(30)) / 2.0;
    const double l = static_cast<double>(random.Below(30)) / 2.0;
    const double lambda = random.Uniform();
    const double gamma = random.Uniform();
    const DrawProbabilities draw = ComputeDrawProbabilities(p, l, lambda, gamma);
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

struct World {
  std::uint32_t points;
  std::uint32_t right_points;
  std::uint32_t lines;
  std::uint32_t right_lines;
};

// Draws as the three strategies do, and counts. Five standard errors.
void ExpectDrawingAgrees(const World& world, Random& random) {
  constexpr int kDraws = 200000;
  int hits_1p1l = 0;
  int hits_2p = 0;
  int hits_mixed = 0;
  for (int i = 0; i < kDraws; ++i) {
    const std::uint32_t first = random.Below(world.points);
    const bool first_right = first < world.right_points;
    hits_1p1l += first_right && random.Below(world.lines) < world.right_lines;
    const auto other_point = [&](std::uint32_t draw) { return draw < first ? draw : draw + 1; };
    hits_2p += first_right && other_point(random.Below(world.points - 1)) < world.right_points;
    const std::uint32_t second = random.Below(world.points - 1 + world.lines);
    const bool second_right = second < world.points - 1
                                  ? other_point(second) < world.right_points
                                  : second - (world.points - 1) < world.right_lines;
    hits_mixed += first_right && second_right;
  }
  const DrawProbabilities draw = ComputeDrawProbabilities(
      world.points, world.lines, static_cast<double>(world.right_points) / world.points,
      static_cast<double>(world.right_lines) / world.lines);
  const double tolerance = 5.0 * 0.5 / std::sqrt(static_cast<double>(kDraws));
  EXPECT_NEAR(static_cast<double>(hits_1p1l) / kDraws, draw.p1p1l, tolerance);
  EXPECT_NEAR(static_cast<double>(hits_2p) / kDraws, draw.p2p, tolerance);
  EXPECT_NEAR(static_cast<double>(hits_mixed) / kDraws, draw.mixed, tolerance);
}

TEST(DrawProbabilities, AgreeWithDrawing) {
  Random random = TestRandom();
  for (const World& world :
       {World{10, 5, 5, 2}, World{3, 2, 30, 20}, World{50, 5, 4, 4}, World{2, 2, 1, 1}}) {
    ExpectDrawingAgrees(world, random);
  }
}

}  // namespace
}  // namespace maploc
