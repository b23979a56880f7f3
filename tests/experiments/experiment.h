// An experiment: one command. It turns what was asked for into rows; how rows are shown is the same
// for all (report.h).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/experiments/methods/method.h"
#include "tests/experiments/row.h"
#include "tests/experiments/view.h"

namespace maploc::experiments {

struct RunOptions {
  std::vector<std::string> methods;  // names that exist
  int trials = 0;                    // at least 1
  std::uint64_t seed = 1;
  std::vector<std::string> only;  // KEY=VALUE: settings with this value alone
};

struct Experiment {
  std::string name;
  std::string description;
  std::string example;
  std::vector<std::string> default_methods;
  int default_trials = 200;
  std::vector<View> views;  // tables and charts
  std::function<Result<Rows>(const RunOptions&)> run;
};

Experiment AccuracyExperiment();
Experiment SensitivityExperiment();
Experiment RobustnessExperiment();
Experiment TimingExperiment();
Experiment FalseAcceptsExperiment();
Experiment ReliabilityExperiment();

}  // namespace maploc::experiments
