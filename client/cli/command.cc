#include "client/cli/commands.h"
#include "client/cli/output.h"

namespace maploc {

CLI::App* AddCommand(CLI::App& app, CommandContext& context, const std::string& name,
                     const std::string& description, const std::string& example,
                     std::function<Status()> run) {
  CLI::App* command = app.add_subcommand(name, description);
  command->footer("Example:\n" + example);
  command->add_flag("--json", context.json,
                    "one JSON document on standard output, everything else on standard error");
  command->callback([&context, run = std::move(run)] { context.chosen = run; });
  return command;
}

CLI::Option* AddServerFlag(CLI::App& command, CommandContext& context) {
  return command.add_option("--server", context.server, "the server's HOST:PORT");
}

Status CheckRange(const char* flag, double value, double least, double most) {
  if (value >= least && value <= most) return Status::Ok();
  return InvalidArgument(flag,
                         "must lie in " + FormatNumber(least, 0) + " to " + FormatNumber(most, 0));
}

}  // namespace maploc
