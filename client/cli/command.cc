#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iostream>

#include "client/cli/commands.h"
#include "client/cli/output.h"

namespace maploc {

namespace {

// Of HOST:PORT and of gRPC's longer forms; "unix:/path" has no port.
std::string CheckServer(const std::string& server) {
  const std::size_t colon = server.rfind(':');
  if (server.starts_with("unix:")) return "";
  if (colon == std::string::npos || colon == 0) return "must be HOST:PORT, got '" + server + "'";
  // Looked at here, because gRPC's own messages about a bad port do not name it.
  int port = 0;
  const char* end = server.data() + server.size();
  const auto [parsed, error] = std::from_chars(server.data() + colon + 1, end, port);
  if (error == std::errc() && parsed == end && port >= 1 && port <= 65535) return "";
  return "the port of '" + server + "' must be in [1, 65535]";
}

}  // namespace

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
  command
      .add_option("--timeout", context.timeout_s,
                  "seconds that an answer may take; later it is DEADLINE_EXCEEDED")
      ->capture_default_str();
  command.add_option("--ca", context.credentials.ca,
                     "authority of the server's certificate (PEM): the connection is encrypted");
  command.add_option("--cert", context.credentials.cert,
                     "own certificate (PEM), where the server asks for one");
  command.add_option("--key", context.credentials.key, "the private key of --cert (PEM)");
  command.add_option("--token-file", context.credentials.token,
                     "file of the token that the server asks for (or the environment: "
                     "MAPLOC_TOKEN)");
  return command.add_option("--server", context.server, "the server's HOST:PORT")
      ->check(CheckServer);
}

Result<ClientOptions> ClientOptionsFrom(const CommandContext& context) {
  constexpr double kLeastS = 0.001;
  constexpr double kMostS = 86400.0;
  // Negated, so that a NaN is refused too.
  if (!(context.timeout_s >= kLeastS && context.timeout_s <= kMostS)) {
    return InvalidArgument("--timeout", "must lie in 0.001 to 86400 seconds");
  }
  ClientOptions options;
  options.call_timeout = std::chrono::milliseconds(std::llround(1000.0 * context.timeout_s));
  MAPLOC_ASSIGN_OR_RETURN(options.credentials, ReadCredentials(context.credentials));
  // A flag goes before the environment.
  const char* const token = std::getenv("MAPLOC_TOKEN");
  if (token != nullptr && *token != '\0' && options.credentials.token.empty()) {
    MAPLOC_RETURN_IF_ERROR(CheckTokenText("MAPLOC_TOKEN", token));
    options.credentials.token = token;
  }
  return options;
}

Result<Client> Connect(const CommandContext& context) {
  MAPLOC_ASSIGN_OR_RETURN(const ClientOptions options, ClientOptionsFrom(context));
  return Client(context.server, options);
}

void PrintNotes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) std::cerr << "note: " << note << "\n";
}

Status CheckRange(const char* flag, double value, double least, double most) {
  if (value >= least && value <= most) return Status::Ok();
  return InvalidArgument(flag,
                         "must lie in " + FormatNumber(least, 0) + " to " + FormatNumber(most, 0));
}

}  // namespace maploc
