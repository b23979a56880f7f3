// maploc-experiments' command line. A command leaves its work in the context; main runs it and
// turns its Status into the exit code.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "mapstore/base/status.h"
#include "tests/experiments/experiment.h"

namespace maploc::experiments {

// Lives as long as the command line's parser.
struct CommandContext {
  std::function<Status()> chosen;
};

// A command of the experiment's name with --methods, --trials, --seed, --only, --json, --csv and
// --plot.
CLI::App* AddExperiment(CLI::App& app, CommandContext& context, const Experiment& experiment);

}  // namespace maploc::experiments
