// maploc-map: everything an operator does with a store. Contract: exit code 0 done, 1 failed (one
// line on standard error), 2 wrong usage.
#include <csignal>
#include <exception>
#include <iostream>

#include "mapstore/base/standard_output.h"
#include "mapstore/base/usage.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/compare.h"
#include "mapstore/tools/restore.h"
#ifdef MAPLOC_HAS_IMPORT_COLMAP
#include "mapstore/tools/import_colmap.h"
#endif

namespace {

void AddCommands(CLI::App& app, maploc::CommandContext& context) {
#ifdef MAPLOC_HAS_IMPORT_COLMAP
  maploc::AddImportColmap(app, context);
#endif
  maploc::AddListCommand(app, context);
  maploc::AddVersionsCommand(app, context);
  maploc::AddCompareCommand(app, context);
  maploc::AddEnableCommand(app, context);
  maploc::AddRollbackCommand(app, context);
  maploc::AddDeleteCommand(app, context);
  maploc::AddSegmentsCommand(app, context);
  maploc::AddStatsCommand(app, context);
  maploc::AddStrategyCommand(app, context);
  maploc::AddExplainCommand(app, context);
  maploc::AddRobotsCommand(app, context);
  maploc::AddSessionsCommand(app, context);
  maploc::AddRevokeCommand(app, context);
  maploc::AddVerifyCommand(app, context);
  maploc::AddLevelCommand(app, context);
  maploc::AddExportCommand(app, context);
  maploc::AddImportCommand(app, context);
  maploc::AddBackupCommand(app, context);
  maploc::AddRestoreCommand(app, context);
  maploc::AddPlotCommand(app, context);
}

// A failure's message may quote a file's content; it stays on one line all the same.
std::string OneLine(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

// Failure is a value here; what is thrown all the same comes from below: no memory, a strange path.
maploc::Status Run(const maploc::CommandContext& context) {
  try {
    MAPLOC_RETURN_IF_ERROR(context.chosen());
    return maploc::FlushStandardOutput();
  } catch (const std::exception& error) {
    return maploc::Internal(error.what());
  }
}

int Report(const maploc::Status& status) {
  if (status.ok()) return 0;
  std::cerr << "maploc-map: " << OneLine(status.message()) << "\n";
  return maploc::kExitFailed;
}

}  // namespace

int main(int argc, char** argv) {
  maploc::OpenStandardFiles();
  // At a limit on the size of files a write fails, and that is told; the program is not ended.
  std::signal(SIGXFSZ, SIG_IGN);
  CLI::App app("Makes, inspects and looks after maploc's stores", "maploc-map");
  app.footer("Each command's --help has an example.");
  app.require_subcommand(1);
  maploc::AddUsage(app);
  maploc::CommandContext context;
  AddCommands(app, context);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.exit(error) != 0) return maploc::kExitWrongUsage;
    return Report(maploc::FlushStandardOutput());
  }
  return Report(Run(context));
}
