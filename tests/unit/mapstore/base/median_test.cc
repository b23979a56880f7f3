#include "mapstore/base/median.h"

#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

namespace maploc {
namespace {

TEST(Median, OfAnOddCountIsTheMiddleOne) {
  EXPECT_EQ(Median(std::vector{7.0}), 7.0);
  EXPECT_EQ(Median(std::vector{9.0, -1.0, 2.0, 2.0, 100.0}), 2.0);
  EXPECT_EQ(UpperMedian(std::vector{9.0, -1.0, 2.0, 2.0, 100.0}), 2.0);
}

TEST(Median, OfAnEvenCountIsTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(Median(std::vector{4.0, 1.0, 3.0, 100.0}), 3.5);
  EXPECT_EQ(Median(std::vector{1, 2}), 1.5);
}

TEST(Median, OfWholeNumbersDoesNotOverflow) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(Median(std::vector{kMost, kMost}), static_cast<double>(kMost));
}

TEST(UpperMedian, OfAnEvenCountIsTheHigherOfTheMiddleTwo) {
  EXPECT_EQ(UpperMedian(std::vector{4.0, 1.0, 3.0, 100.0}), 4.0);
  EXPECT_EQ(UpperMedian(std::vector{1, 2}), 2);
}

}  // namespace
}  // namespace maploc
