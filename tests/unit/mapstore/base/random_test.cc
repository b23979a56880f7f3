#include "mapstore/base/random.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/seed.h"

namespace maploc {
namespace {

// Stored results depend on the stream, so it may not change by accident: the values of xoshiro256++
// seeded by SplitMix64.
TEST(RandomTest, TheStreamOfASeedIsFixed) {
  Random random(1);
  EXPECT_EQ(random.Next(), 14971601782005023387u);
  EXPECT_EQ(random.Next(), 13781649495232077965u);
}

TEST(RandomTest, BelowReachesEveryValueEvenly) {
  Random random = testing::TestRandom();
  std::vector<int> counts(7, 0);
  constexpr int kDraws = 70000;
  for (int i = 0; i < kDraws; ++i) ++counts[random.Below(7)];
  for (const int count : counts) EXPECT_NEAR(count, kDraws / 7, 5 * std::sqrt(kDraws / 7.0));
}

TEST(RandomTest, GaussianHasItsMoments) {
  Random random = testing::TestRandom();
  constexpr int kDraws = 100000;
  double sum = 0, sum_squares = 0;
  int beyond_two_sigma = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.Gaussian(3.0);
    sum += x;
    sum_squares += x * x;
    beyond_two_sigma += std::abs(x) > 6.0;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 5 * 3.0 / std::sqrt(kDraws));
  EXPECT_NEAR(sum_squares / kDraws, 9.0, 5 * 9.0 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(beyond_two_sigma, 0.0455 * kDraws, 5 * std::sqrt(0.0455 * kDraws));
}

TEST(RandomTest, ForksDifferAndRepeat) {
  const Random random = testing::TestRandom();
  EXPECT_EQ(random.Fork(3).Next(), random.Fork(3).Next());
  EXPECT_NE(random.Fork(3).Next(), random.Fork(4).Next());
}

TEST(HashBytesTest, IsFnv1a) { EXPECT_EQ(HashBytes("a"), 0xaf63dc4c8601ec8cull); }

}  // namespace
}  // namespace maploc
