#include "server/ransac/draw_pool.h"

#include <gtest/gtest.h>

#include "server/ransac/sampler.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

TEST(DrawPool, IsEverythingWithoutQuality) {
  const DrawPool pool(1000, false);
  EXPECT_EQ(pool.SizeOf(1000), 1000u);
  EXPECT_EQ(pool.SizeOf(0), 0u);
}

// n(t) = N sqrt(t / T_N), T_N = N / 2.
TEST(DrawPool, GrowsAsProsacsPool) {
  DrawPool pool(1000, true);
  EXPECT_EQ(pool.SizeOf(1000), 45u);  // 1000 sqrt(1 / 500) = 44.7
  for (int draw = 1; draw < 125; ++draw) pool.Advance();
  EXPECT_EQ(pool.SizeOf(1000), 500u);
  EXPECT_EQ(pool.SizeOf(20), 10u);  // every kind by the same share
  for (int draw = 125; draw < 500; ++draw) pool.Advance();
  EXPECT_EQ(pool.SizeOf(1000), 1000u);
  pool.Advance();
  EXPECT_EQ(pool.SizeOf(1000), 1000u);
}

TEST(DrawPool, NeverStarvesAKindOfFeature) {
  const DrawPool pool(10000, true);
  EXPECT_EQ(pool.SizeOf(5), 5u);
  EXPECT_EQ(pool.SizeOf(100), DrawPool::kLeast);
}

enum class Order { kNone, kUseful, kUseless, kInverse };

// Mean draws of 2P until a sample is all inliers, 40 of 400 points.
double MeanDraws(Order order) {
  Random random = TestRandom();
  SyntheticOptions options;
  options.point_inliers = 40;
  options.point_outliers = 360;
  constexpr int kProblems = 200;
  long draws = 0;
  for (int i = 0; i < kProblems; ++i) {
    SyntheticProblem made = MakeSyntheticProblem(options, random);
    for (std::size_t k = 0; k < made.problem.points.size(); ++k) {
      const bool inlier = made.point_is_inlier[k] != 0;
      double& ratio = made.problem.points[k].ratio;
      ratio = order == Order::kNone ? 1.0 : random.Uniform(0.4, 1.0);
      // True matches are better on average, but not apart from the wrong ones.
      if (order == Order::kUseful && inlier) ratio = random.Uniform(0.3, 0.8);
      if (order == Order::kInverse && !inlier) ratio = random.Uniform(0.3, 0.8);
    }
    const PreparedProblem prepared = PrepareProblem(made.problem, random);
    Sampler sampler(prepared, Strategy::k2P);
    for (bool all_inliers = false; !all_inliers; ++draws) {
      const Hypotheses& drawn = sampler.Draw(random);
      all_inliers = drawn.count > 0 && made.point_is_inlier[drawn.sample.points[0]] != 0 &&
                    made.point_is_inlier[drawn.sample.points[1]] != 0;
    }
  }
  return static_cast<double>(draws) / kProblems;
}

// Without an order a good draw comes after some 150 draws (1 in 100, and the gates); standard
// error of a mean over 200 problems: 7%.
TEST(DrawPool, AUsefulOrderIsWorthMuchAndAUselessOneCostsLittle) {
  const double none = MeanDraws(Order::kNone);
  EXPECT_LT(MeanDraws(Order::kUseful), 0.6 * none);
  EXPECT_LT(MeanDraws(Order::kUseless), 1.3 * none);
  EXPECT_LT(MeanDraws(Order::kInverse), 2.5 * none);
}

}  // namespace
}  // namespace maploc::testing
