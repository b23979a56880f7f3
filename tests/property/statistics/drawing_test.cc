// The probabilities against drawing as the sampler does (server/ransac/sampler.cc), from finite
// populations with exact counts.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "mapstore/statistics/probabilities.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

using testing::TestRandom;

constexpr int kDraws = 20000;
constexpr int kMaxRedraws = 10;

// So many features, of which the first few are right.
struct Population {
  std::uint32_t all = 0;
  std::uint32_t right = 0;
};

struct World {
  Population points;
  Population usable;
  Population vertical;

  // 1P1L's rule stops at ten usable lines.
  bool DrawsVertical(Strategy strategy) const {
    return vertical.all >= 2 && vertical.all > usable.all &&
           (strategy == Strategy::kMixed || usable.all < 10);
  }
  std::uint32_t LineEntities(Strategy strategy) const {
    return usable.all + (DrawsVertical(strategy) ? vertical.all : 0);
  }
};

enum class Drawn { kRefused, kWrong, kRight };

Drawn Judge(bool right) { return right ? Drawn::kRight : Drawn::kWrong; }

Drawn DrawSecondPoint(const World& world, std::uint32_t first, std::uint32_t draw) {
  const std::uint32_t second = draw < first ? draw : draw + 1;
  return Judge(first < world.points.right && second < world.points.right);
}

// A vertical line asks for a second one; the same one twice is refused.
Drawn DrawLine(const World& world, std::uint32_t first, std::uint32_t entity, Random& random) {
  const bool point_right = first < world.points.right;
  if (entity < world.usable.all) return Judge(point_right && entity < world.usable.right);
  const std::uint32_t line = entity - world.usable.all;
  const std::uint32_t other = random.Below(world.vertical.all);
  if (other == line) return Drawn::kRefused;
  return Judge(point_right && line < world.vertical.right && other < world.vertical.right);
}

bool CanDraw(const World& world, Strategy strategy) {
  if (world.points.all < 1) return false;
  if (strategy == Strategy::k2P) return world.points.all >= 2;
  if (strategy == Strategy::k1P1L) return world.LineEntities(strategy) >= 1;
  return world.points.all + world.LineEntities(strategy) >= 2;
}

Drawn DrawOnce(const World& world, Strategy strategy, Random& random) {
  const std::uint32_t first = random.Below(world.points.all);
  const std::uint32_t others = world.points.all - 1;
  if (strategy == Strategy::k2P) return DrawSecondPoint(world, first, random.Below(others));
  if (strategy == Strategy::k1P1L) {
    return DrawLine(world, first, random.Below(world.LineEntities(strategy)), random);
  }
  const std::uint32_t second = random.Below(others + world.LineEntities(strategy));
  if (second < others) return DrawSecondPoint(world, first, second);
  return DrawLine(world, first, second - others, random);
}

bool DrawSucceeds(const World& world, Strategy strategy, Random& random) {
  for (int redraws = 0; redraws <= kMaxRedraws; ++redraws) {
    const Drawn drawn = DrawOnce(world, strategy, random);
    if (drawn != Drawn::kRefused) return drawn == Drawn::kRight;
  }
  return false;
}

double Rate(const Population& population) {
  return population.all > 0 ? static_cast<double>(population.right) / population.all : 0.0;
}

// Small counts, one and none of each kind, all wrong and all right among them.
std::vector<World> Grid() {
  const Population points[] = {{0, 0}, {1, 0}, {1, 1},   {2, 1},  {2, 2},
                               {3, 2}, {7, 1}, {20, 12}, {60, 3}, {200, 50}};
  const Population usable[] = {{0, 0}, {1, 1}, {2, 1}, {5, 0}, {12, 4}, {40, 36}};
  const Population vertical[] = {{0, 0}, {1, 1}, {2, 1}, {2, 2}, {3, 2}, {9, 3}, {50, 25}};
  std::vector<World> worlds;
  for (const Population& p : points) {
    for (const Population& l : usable) {
      for (const Population& v : vertical) worlds.push_back({p, l, v});
    }
  }
  return worlds;
}

// In how many standard deviations of the draws' mean it differs from the probability.
double Deviation(const World& world, Strategy strategy, double probability, Random& random) {
  if (!CanDraw(world, strategy)) {
    EXPECT_EQ(probability, 0.0);
    return 0.0;
  }
  int hits = 0;
  for (int i = 0; i < kDraws; ++i) hits += DrawSucceeds(world, strategy, random) ? 1 : 0;
  if (probability == 0.0) {
    EXPECT_EQ(hits, 0);
  }
  const double sigma = std::sqrt(probability * (1.0 - probability) / kDraws);
  const double difference = std::abs(static_cast<double>(hits) / kDraws - probability);
  return sigma > 0.0 ? difference / sigma : 0.0;
}

// Three standard deviations: one in 370 comparisons is beyond them by chance, and none beyond five.
TEST(DrawProbabilities, AgreeWithDrawingWithinThreeSigma) {
  Random random = TestRandom();
  int compared = 0;
  int beyond_three = 0;
  double largest = 0.0;
  for (const World& world : Grid()) {
    const StrategyValues draw = DrawProbabilities(
        {static_cast<double>(world.points.all), static_cast<double>(world.usable.all),
         static_cast<double>(world.vertical.all)},
        {Rate(world.points), Rate(world.usable), Rate(world.vertical)});
    for (const Strategy strategy : {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed}) {
      SCOPED_TRACE(::testing::Message()
                   << StrategyName(strategy) << " points " << world.points.right << "/"
                   << world.points.all << " usable " << world.usable.right << "/"
                   << world.usable.all << " vertical " << world.vertical.right << "/"
                   << world.vertical.all);
      const double deviation = Deviation(world, strategy, draw.Of(strategy), random);
      EXPECT_LT(deviation, 5.0);
      ++compared;
      beyond_three += deviation > 3.0 ? 1 : 0;
      largest = std::max(largest, deviation);
    }
  }
  // Expected 1260 x 0.0027 = 3.4 at the most; more than 10 happen in one run of 700.
  EXPECT_LE(beyond_three, 10);
  std::cout << compared << " comparisons, " << beyond_three << " beyond 3 sigma, largest "
            << largest << "\n";
}

}  // namespace
}  // namespace maploc
