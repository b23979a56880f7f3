// Runs settings: the same problems for every method, whatever methods are asked for.
#pragma once

#include "tests/experiments/experiment.h"
#include "tests/experiments/setting.h"

namespace maploc::experiments {

// A row a setting and method, in this order. A trial's problem comes from (seed, setting, trial)
// alone, and every method gets the same seed for its own draws. A method that cannot draw a sample
// for want of lines has no row. Medians count an unanswered trial as infinitely wrong, and are left
// out where that is the median. INVALID_ARGUMENT when `only` leaves no setting.
Result<Rows> RunSettings(const std::vector<Setting>& settings, const RunOptions& options);

// The generator of one trial: from (seed, name, trial).
Random TrialRandom(std::uint64_t seed, const std::string& name, int trial);

// Whether the row has the value of every KEY=VALUE.
// INVALID_ARGUMENT where one is not KEY=VALUE.
Result<bool> Matches(const Row& keys, const std::vector<std::string>& only);

// The p-quantile by nearest rank. REQUIRES: values not empty, 0 <= p <= 1.
double Quantile(std::vector<double> values, double p);

}  // namespace maploc::experiments
