#include "mapstore/importers/parallel.h"

#include <atomic>
#include <new>

#include <gtest/gtest.h>

namespace maploc {
namespace {

TEST(ParallelFor, GivesAnExceptionToTheCallerAndBeginsNothingElse) {
  std::atomic<int> begun = 0;
  EXPECT_THROW(ParallelFor(1'000'000,
                           [&begun](int) {
                             ++begun;
                             throw std::bad_alloc();
                           }),
               std::bad_alloc);
  EXPECT_LE(begun, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace
}  // namespace maploc
