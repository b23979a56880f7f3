// One cell of an experiment: how its problems are made, what a method is given, what is right.
#pragma once

#include "tests/experiments/methods/method.h"
#include "tests/experiments/row.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::experiments {

enum class Success {
  kPaper,  // rotation within 5 degrees, translation within 10%
  kClose,  // rotation within 1 degree, position within 0.25 m
};

struct Setting {
  Row keys;  // of the row, from `experiment` on, without method and results; names the seeds
  testing::SyntheticOptions synthetic;
  MethodOptions limits;  // the seed is chosen a trial
  Success success = Success::kPaper;
};

}  // namespace maploc::experiments
