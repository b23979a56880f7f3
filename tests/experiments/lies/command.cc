#include "tests/experiments/lies/command.h"

#include <memory>

#include "tests/experiments/lies/recorded_sets.h"
#include "tests/experiments/lies/run_lies.h"
#include "tests/experiments/report.h"
#include "tests/support/shared_data.h"

namespace maploc::lies {
namespace {

struct Flags {
  LieOptions run;
  std::string refinement = "auto";
  experiments::ReportOptions report;
};

Status Run(Flags flags) {
  if (flags.run.draws < 1) return InvalidArgument("--draws", "must be at least 1");
  flags.run.refinement = flags.refinement == "4dof"   ? Refinement::k4Dof
                         : flags.refinement == "6dof" ? Refinement::k6Dof
                                                      : Refinement::kAuto;
  MAPLOC_RETURN_IF_ERROR(experiments::CheckWritable(flags.report));
  MAPLOC_ASSIGN_OR_RETURN(const experiments::Rows rows, RunLies(flags.run));
  return experiments::ReportRows(rows, {}, flags.report);
}

}  // namespace

CLI::App* AddLiesCommand(CLI::App& app, experiments::CommandContext& context) {
  auto flags = std::make_shared<Flags>();
  flags->run.data_folder = testing::SharedDataFolder().string();
  flags->run.sets = SetNames();
  CLI::App* command = app.add_subcommand(
      "lies", "Recorded queries whose gravity, calibration or picture lies: what is LOCALIZED?");
  command->footer("Example:\n  maploc-experiments lies --sets herzjesu --families frame,turn");
  command->add_option("--data", flags->run.data_folder, "The folder that holds the real sets")
      ->capture_default_str();
  command->add_option("--sets", flags->run.sets, "Separated by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(SetNames()))
      ->capture_default_str();
  command
      ->add_option("--families", flags->run.families,
                   "Of honest, frame, turn, calibration, mirror, patch, few; all where left out")
      ->delimiter(',');
  command->add_option("--draws", flags->run.draws, "A random lie is told so often a query")
      ->capture_default_str();
  command->add_option("--seed", flags->run.seed, "The same seed tells the same lies")
      ->capture_default_str();
  command->add_option("--refine", flags->refinement, "")
      ->check(CLI::IsMember({"auto", "4dof", "6dof"}))
      ->capture_default_str();
  command->add_flag("--verbose", flags->run.verbose,
                    "Each answer that is off or beyond 3.5 of its sigmas, on standard error");
  command->add_flag("--json", flags->report.json,
                    "A JSON list of rows on standard output, everything else on standard error");
  command->add_option("--csv", flags->report.csv_file, "Also write the rows into this file");
  command->callback([&context, flags] { context.chosen = [flags] { return Run(*flags); }; });
  return command;
}

}  // namespace maploc::lies
