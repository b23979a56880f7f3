// maploc: the robot's side of map localization.
#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>

#include "client/cli/commands.h"
#include "mapstore/base/standard_output.h"
#include "mapstore/base/usage.h"

namespace maploc {
namespace {

// One line, cause and cure, whatever a server or a library put into the message.
int Report(const Status& status) {
  if (status.ok()) return 0;
  std::string line = "maploc: " + status.ToString();
  if (status.code() == StatusCode::kDeadlineExceeded) line += "; --timeout SECONDS waits longer";
  std::ranges::replace(line, '\n', ' ');
  std::cerr << line << "\n";
  return kExitFailed;
}

// Failure is a value here; what is thrown all the same comes from below: no memory, a strange path.
Status Run(const CommandContext& context) {
  try {
    MAPLOC_RETURN_IF_ERROR(context.chosen());
    return FlushStandardOutput();
  } catch (const std::exception& error) {
    return Internal(error.what());
  }
}

int Main(int argc, char** argv) {
  // At a limit on the size of files a write fails, and that is told; the program is not ended.
  std::signal(SIGXFSZ, SIG_IGN);
  CLI::App app("maploc: localize a robot in a server's map, or replay a recorded one", "maploc");
  app.require_subcommand(1);
  AddUsage(app);
  CommandContext context;
  AddLocalizeCommand(app, context);
  AddReplayCommand(app, context);
  AddEndSessionCommand(app, context);
  AddLoadCommand(app, context);
  AddSimulateCommand(app, context);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.exit(error, std::cout, std::cerr) != 0) return kExitWrongUsage;
    // --help and --version are output too, and may meet a full disk.
    return Report(FlushStandardOutput());
  }
  return Report(Run(context));
}

}  // namespace
}  // namespace maploc

int main(int argc, char** argv) {
  maploc::OpenStandardFiles();
  return maploc::Main(argc, argv);
}
