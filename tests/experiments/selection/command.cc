#include "tests/experiments/selection/command.h"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

#include "mapstore/tools/output.h"
#include "tests/experiments/progress.h"
#include "tests/experiments/report.h"
#include "tests/experiments/selection/report.h"
#include "tests/experiments/selection/run_selection.h"
#include "tests/experiments/selection/tables.h"

namespace maploc::selection {
namespace {

struct Flags {
  SelectionFlags run;
  std::vector<double> gravity;  // empty or three
  experiments::ReportOptions report;
};

// One line a session.
class SessionProgress {
 public:
  void Step(std::string_view session, int total) {
    if (session != session_) {
      session_ = session;
      progress_ = std::make_unique<experiments::Progress>("selection, " + session_, total);
    }
    progress_->Step();
  }

 private:
  std::string session_;
  std::unique_ptr<experiments::Progress> progress_;
};

Status Check(const Flags& flags) {
  if (flags.run.trials.trials < 1) return InvalidArgument("--trials", "must be at least 1");
  if (flags.run.queries < 1) return InvalidArgument("--queries", "must be at least 1");
  return experiments::CheckWritable(flags.report);
}

Status WriteChart(const SelectionResult& result, const std::string& folder) {
  const std::filesystem::path path = std::filesystem::path(folder) / "selection.svg";
  std::ofstream file(path);
  file << experiments::DrawSvg(SuccessChart(result));
  file.close();
  return file ? Status::Ok()
              : InvalidFile(path.string(), "cannot be written; choose a folder that can");
}

Status Report(const SelectionResult& result, const experiments::ReportOptions& options) {
  if (!options.csv_file.empty()) {
    MAPLOC_RETURN_IF_ERROR(experiments::WriteCsv(ToRows(result), options.csv_file));
  }
  if (!options.plot_folder.empty()) {
    MAPLOC_RETURN_IF_ERROR(WriteChart(result, options.plot_folder));
  }
  options.json ? PrintJson(ToJson(result)) : PrintTables(result, std::cout);
  return Status::Ok();
}

Status Run(const Flags& flags) {
  MAPLOC_RETURN_IF_ERROR(Check(flags));
  SelectionFlags run = flags.run;
  if (!flags.gravity.empty()) {
    run.gravity_in_source = Eigen::Vector3d(flags.gravity[0], flags.gravity[1], flags.gravity[2]);
  }
  Result<SelectionResult> result = Status(Internal("not run"));
  {
    SessionProgress progress;
    result = RunSelection(
        run, [&](std::string_view session, int, int total) { progress.Step(session, total); });
  }
  if (!result.ok()) return result.status();
  return Report(*result, flags.report);
}

void AddRunFlags(CLI::App& command, Flags& flags) {
  command
      .add_option("--set", flags.run.set,
                  "campus (simulated), or a folder with map/, database.db and sessions")
      ->type_name("campus|DIR")
      ->capture_default_str();
  command
      .add_option("--methods", flags.run.methods,
                  "The methods to report beside the selection, separated by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(kMethods.begin(), kMethods.end())))
      ->capture_default_str();
  command
      .add_option("--trials", flags.run.trials.trials, "Searches a query and method, each seeded")
      ->capture_default_str();
  command.add_option("--queries", flags.run.queries, "Of a session of the campus")
      ->capture_default_str();
  command.add_option("--seed", flags.run.trials.seed, "Of the campus, its robots and the searches")
      ->capture_default_str();
  command
      .add_option("--gravity", flags.gravity,
                  "Down in the folder's model; else the mean of gravity.csv")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
}

}  // namespace

CLI::App* AddSelectionCommand(CLI::App& app, experiments::CommandContext& context) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command = app.add_subcommand(
      "selection", "Leave one session out: what the others taught, against every single strategy");
  command->footer("Example:\n  maploc-experiments selection --set campus --trials 5 --plot charts");
  AddRunFlags(*command, *flags);
  command->add_flag("--json", flags->report.json,
                    "One JSON document on standard output, everything else on standard error");
  command->add_option("--csv", flags->report.csv_file, "Also write a row a session and method");
  command->add_option("--plot", flags->report.plot_folder,
                      "Also draw the success curves (SVG) into this folder");
  command->callback([&context, flags] { context.chosen = [flags] { return Run(*flags); }; });
  return command;
}

}  // namespace maploc::selection
