#include "mapstore/base/usage.h"

#include <cmath>
#include <vector>

namespace maploc {

void AddUsage(CLI::App& app) {
  app.set_version_flag("--version", app.get_name() + " " + MAPLOC_VERSION);
  app.failure_message(WrongUsage);
}

std::string WrongUsage(const CLI::App* app, const CLI::Error& error) {
  std::string command = app->get_name();
  for (const CLI::App* chosen : app->get_subcommands()) command += " " + chosen->get_name();
  const std::vector<std::string> unknown = app->remaining(/*recurse=*/true);
  // CLI11 looks for missing flags before unknown words, so that it would report a misspelt flag as
  // a missing one. All its other errors name the word that is wrong.
  const bool names_another =
      error.get_exit_code() != static_cast<int>(CLI::ExitCodes::ExtrasError) &&
      error.get_exit_code() != static_cast<int>(CLI::ExitCodes::RequiredError);
  const std::string what =
      unknown.empty() || names_another ? error.what() : "unknown " + unknown.front();
  return command + ": " + what + "; see " + command + " --help\n";
}

CLI::Validator NumberIn(double least, double most) {
  const CLI::Range range(least, most);
  return CLI::Validator(
      [range](std::string& text) -> std::string {
        double number = 0.0;
        if (CLI::detail::lexical_cast(text, number) && std::isnan(number))
          return "NaN is no number";
        return range(text);
      },
      range.get_description());
}

}  // namespace maploc
