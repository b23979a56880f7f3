#include "tests/experiments/commands.h"

#include <memory>

#include "tests/experiments/report.h"

namespace maploc::experiments {
namespace {

struct Flags {
  RunOptions run;
  ReportOptions report;
};

Status Run(const Experiment& experiment, const Flags& flags) {
  if (flags.run.trials < 1) return InvalidArgument("--trials", "must be at least 1");
  MAPLOC_RETURN_IF_ERROR(CheckWritable(flags.report));
  Rows earlier;
  if (!flags.report.earlier_file.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(earlier, ReadRows(flags.report.earlier_file, experiment.name));
  }
  MAPLOC_ASSIGN_OR_RETURN(Rows rows, experiment.run(flags.run));
  rows.insert(rows.end(), earlier.begin(), earlier.end());
  return ReportRows(rows, experiment.views, flags.report);
}

}  // namespace

CLI::App* AddExperiment(CLI::App& app, CommandContext& context, const Experiment& experiment) {
  auto flags = std::make_shared<Flags>();
  flags->run.methods = experiment.default_methods;
  flags->run.trials = experiment.default_trials;
  CLI::App* command = app.add_subcommand(experiment.name, experiment.description);
  command->footer("Example:\n  " + experiment.example);
  command
      ->add_option("--methods", flags->run.methods, "The methods to compare, separated by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(AllMethodNames()))
      ->capture_default_str();
  command->add_option("--trials", flags->run.trials, "Trials a setting")->capture_default_str();
  command->add_option("--seed", flags->run.seed, "The same seed makes the same problems")
      ->capture_default_str();
  command->add_option("--only", flags->run.only,
                      "KEY=VALUE: only settings whose row has this value; may be repeated");
  command->add_flag("--json", flags->report.json,
                    "A JSON list of rows on standard output, everything else on standard error");
  command->add_option("--add", flags->report.earlier_file,
                      "Show the rows of an earlier run's --json beside the new ones; with the same "
                      "--seed and --trials they saw the same problems");
  command->add_option("--csv", flags->report.csv_file, "Also write the rows into this file");
  command->add_option("--plot", flags->report.plot_folder,
                      "Also draw charts (SVG) into this folder");
  command->callback(
      [&context, flags, experiment] { context.chosen = [=] { return Run(experiment, *flags); }; });
  return command;
}

}  // namespace maploc::experiments
