// maploc-experiments: the paper's experiments beside the peers. Exit code 0 done, 1 failed (one
// line on standard error), 2 wrong usage.
#include <algorithm>
#include <iostream>

#include "mapstore/base/standard_output.h"
#include "mapstore/base/usage.h"
#include "tests/experiments/commands.h"
#include "tests/experiments/lies/command.h"
#include "tests/experiments/selection/command.h"

namespace maploc::experiments {
namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

int Report(const Status& status) {
  if (status.ok()) return 0;
  std::string line = "maploc-experiments: " + status.message();
  std::ranges::replace(line, '\n', ' ');
  std::cerr << line << "\n";
  return kFailed;
}

int Main(int argc, char** argv) {
  CLI::App app("The paper's experiments beside the peers, in one run", "maploc-experiments");
  app.footer("Each command's --help has an example.");
  app.require_subcommand(1);
  AddUsage(app);
  CommandContext context;
  for (const Experiment& experiment :
       {AccuracyExperiment(), SensitivityExperiment(), RobustnessExperiment(), TimingExperiment(),
        FalseAcceptsExperiment(), ReliabilityExperiment()}) {
    AddExperiment(app, context, experiment);
  }
  selection::AddSelectionCommand(app, context);
  lies::AddLiesCommand(app, context);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.exit(error) != 0) return kWrongUsage;
    return Report(FlushStandardOutput());
  }
  const Status status = context.chosen();
  return Report(status.ok() ? FlushStandardOutput() : status);
}

}  // namespace
}  // namespace maploc::experiments

int main(int argc, char** argv) { return maploc::experiments::Main(argc, argv); }
