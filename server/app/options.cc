#include "server/app/options.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <vector>

#include <CLI/CLI.hpp>

#include "mapstore/base/usage.h"
#include "server/app/check_config.h"
#include "server/app/parse_all.h"
#include "server/recorder/recording_ring.h"

namespace maploc {
namespace {

constexpr char kFooter[] =
    "Each option is also read from the environment (MAPLOC_LISTEN, MAPLOC_IDLE_TIMEOUT, ...) and "
    "from\n"
    "the configuration file (listen = \"127.0.0.1:50052\"); a flag beats the environment, and that "
    "the file.\n"
    "\n"
    "Examples:\n"
    "  maploc-server --store campus.maploc\n"
    "  maploc-server --store campus.maploc --listen 0.0.0.0:50051 --tls-cert server.crt --tls-key "
    "server.key\n"
    "  maploc-server --config /etc/maploc/server.toml --check-config\n"
    "  maploc-server token create --store campus.maploc --role robot --robot rover-1\n"
    "\n"
    "Tokens: maploc-server token --help.\n";

std::string CheckListen(const std::string& listen) {
  const std::size_t colon = listen.rfind(':');
  if (colon == std::string::npos || colon == 0) return "must be HOST:PORT, got '" + listen + "'";
  int port = -1;
  const char* end = listen.data() + listen.size();
  const auto [parsed, error] = std::from_chars(listen.data() + colon + 1, end, port);
  if (error != std::errc() || parsed != end || port < 0 || port > 65535) {
    return "the port of '" + listen + "' must be in [0, 65535]";
  }
  return "";
}

// What AsSizeValue made of a size: one without a unit stands as it was, one beyond 64 bits has
// become their largest number.
std::string CheckBytes(const std::string& bytes) {
  constexpr std::size_t kMaxDigits = 18;
  const bool good = bytes.size() <= kMaxDigits && !bytes.starts_with('-');
  return good ? "" : "must be a size from 0 to 10^18 bytes";
}

std::string CheckRecorderBytes(const std::string& bytes) {
  const std::string fault = CheckBytes(bytes);
  if (!fault.empty()) return fault;
  return std::stoll(bytes) >= kMinRecorderBytes ? "" : "must be at least 64MiB";
}

void AddRecorderOptions(CLI::App& app, ServerOptions& options) {
  app.add_option("--recorder", options.recorder.folder,
                 "Folder for a recording of queries (features, gravity, answer; no image, no "
                 "token): all that are refused or doubtful and a sample of the rest, for `maploc "
                 "replay --recorded` and `maploc-map compare`; left out: none");
  app.add_option("--recorder-bytes", options.recorder.max_bytes,
                 "What the recording may take on disk (1GiB, 20GB, bytes); the oldest queries go")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/true))
      ->check(CheckRecorderBytes);
  app.add_option("--recorder-every", options.recorder.every,
                 "Of the queries that are localized without doubt each Nth is recorded")
      ->check(CLI::Range(1, 1'000'000'000));
}

void AddLogOptions(CLI::App& app, ServerOptions& options) {
  app.add_option("--log-level", options.log_level, "debug, info, warn or error")
      ->check(CLI::IsMember({"debug", "info", "warn", "error"}));
  app.add_option("--log-format", options.log_format, "text, or json: one object a line")
      ->check(CLI::IsMember({"text", "json"}));
  app.add_option("--log-requests", options.request_log.every,
                 "Each Nth request has a line, and all that are refused or slow; 0: these alone")
      ->check(CLI::Range(0, 1'000'000'000));
  app.add_option("--slow-query-ms", options.request_log.slow_ms,
                 "From here on a request is slow, and its line has the stages' times; 0: none is")
      ->check(NumberIn(0.0, 1e9));
}

void AddOptions(CLI::App& app, ServerOptions& options) {
  app.add_option("--store", options.store, "The store's file (SQLite); made where it is missing")
      ->required();
  app.add_option("--listen", options.listen, "HOST:PORT; port 0 lets the system choose")
      ->check(CheckListen);
  CLI::Option* cert =
      app.add_option("--tls-cert", options.tls.cert,
                     "The server's certificate and those up to its authority (PEM); "
                     "a renewed one is served without a restart");
  CLI::Option* key =
      app.add_option("--tls-key", options.tls.key, "The certificate's private key (PEM)")
          ->needs(cert);
  cert->needs(key);
  app.add_option("--tls-client-ca", options.tls.client_ca,
                 "Authorities (PEM) of which each client must have a certificate")
      ->needs(cert);
  app.add_flag("--insecure", options.insecure,
               "Listen beyond this machine also without TLS, and without asking for tokens");
  app.add_option("--port-file", options.port_file, "The port in use is written here, atomically");
  app.add_option("--metrics-listen", options.metrics_listen,
                 "HOST:PORT of /metrics (Prometheus) and /healthz over HTTP; left out: none")
      ->check(CheckListen);
  app.add_option("--idle-timeout", options.idle_timeout_s,
                 "Seconds without a query after which a session ends; 0: never")
      ->check(NumberIn(0.0, 1e9));
  app.add_option("--workers", options.workers, "Localizations at the same time; 0: one a core")
      ->check(CLI::Range(0, 1024));
  app.add_option("--queue", options.queue, "Localizations that may wait; 0: eight a worker")
      ->check(CLI::Range(0, 100000));
  app.add_option(
         "--cache-bytes", options.cache_bytes,
         "Memory for segments that are loaded (512MiB, 8GB, bytes); the index of places comes "
         "on top; 0: half of what machine and control group allow")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/true))
      ->check(CheckBytes);
  app.add_option("--max-segments", options.localizer.max_segments_tried,
                 "Segments that are tried for a query, best ranked first")
      ->check(CLI::Range(1, 10000));
  app.add_option("--max-error", options.localizer.max_reprojection_error_px,
                 "Inlier threshold, pixels of a VGA-sized image; larger images scale it")
      ->check(NumberIn(0.1, 1000.0));
  app.add_option("--min-confidence", options.localizer.min_confidence,
                 "Least confidence of a LOCALIZED pose")
      ->check(NumberIn(0.501, 1.0));
  app.add_option("--seed", options.localizer.seed, "Of the sampling; same seed, same answers")
      ->check(CLI::TypeValidator<std::uint64_t>());
  AddLogOptions(app, options);
  AddRecorderOptions(app, options);
}

// "--idle-timeout" -> "MAPLOC_IDLE_TIMEOUT".
std::string EnvironmentName(const std::string& flag) {
  std::string name = "MAPLOC_" + flag.substr(2);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return c == '-' ? '_' : static_cast<char>(std::toupper(c));
  });
  return name;
}

// CLI11 lets the file beat the environment. So the environment's values become flags that stand
// before the real ones: of several the last counts.
std::vector<std::string> Environment(const CLI::App& app) {
  std::vector<std::string> arguments;
  for (const CLI::Option* option : app.get_options()) {
    const std::string flag = "--" + option->get_single_name();
    const char* value = std::getenv(EnvironmentName(flag).c_str());
    const bool is_question = !option->get_configurable() && option != app.get_config_ptr();
    // An empty variable is one that a compose file leaves out. As "--port-file=" CLI11 would take
    // the next argument for its value.
    if (is_question || value == nullptr || *value == '\0') continue;
    arguments.push_back(flag + "=" + value);
  }
  return arguments;
}

// Questions, that neither file nor environment asks.
struct Questions {
  bool check_config = false;
  bool json = false;
};

void AddQuestions(CLI::App& app, Questions& questions) {
  CLI::Option* check = app.add_flag("--check-config", questions.check_config,
                                    "Tell every option in force and every fault, and do not serve")
                           ->configurable(false);
  app.add_flag("--json", questions.json, "What --check-config tells as one JSON document")
      ->configurable(false)
      ->needs(check);
}

int Explain(const CLI::App& app, const CLI::ParseError& error) {
  if (app.exit(error) == 0) return 0;
  const bool of_the_file = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::FileError) ||
                           error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ConfigError);
  // A file that cannot be used is a failure (1), not wrong usage (2).
  return of_the_file ? kExitFailed : kExitWrongUsage;
}

}  // namespace

CommandLine ParseCommandLine(int argc, const char* const* argv) {
  CommandLine result;
  CLI::App app("Serves the maps of a store: robots' sessions and poses.", "maploc-server");
  app.option_defaults()
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
      ->always_capture_default();
  app.footer(kFooter);
  AddUsage(app);
  AddOptions(app, result.options);
  app.set_config("--config", "", "Configuration file (TOML or INI)");
  app.allow_config_extras(CLI::config_extras_mode::error);
  Questions questions;
  AddQuestions(app, questions);
  std::vector<std::string> arguments = Environment(app);
  const std::vector<std::string> flags(argv + 1, argv + argc);
  if (std::ranges::count(flags, "--check-config") > 0) {
    ParsedOptions parsed = ParseAll(app, arguments, flags);
    result.exit_code = CheckConfig(result.options, std::move(parsed), questions.json);
    return result;
  }
  arguments.insert(arguments.end(), flags.begin(), flags.end());
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    result.exit_code = Explain(app, error);
  }
  result.options.request_log.json = result.options.log_format == "json";
  return result;
}

}  // namespace maploc
