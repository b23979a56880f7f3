// Seeds: every test draws from its own, made from its name and printed when it fails.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "mapstore/base/random.h"

namespace maploc::testing {

// The seed of the running test and repetition. MAPLOC_TEST_SEED in the environment is mixed in, to
// look for more.
inline std::uint64_t TestSeed(int repetition = 0) {
  const ::testing::TestInfo* info = ::testing::UnitTest::GetInstance()->current_test_info();
  const char* extra = std::getenv("MAPLOC_TEST_SEED");
  const std::string name = std::string(info->test_suite_name()) + "." + info->name() + "#" +
                           std::to_string(repetition) + (extra != nullptr ? extra : "");
  return HashBytes(name);
}

inline Random TestRandom(int repetition = 0) { return Random(TestSeed(repetition)); }

}  // namespace maploc::testing
