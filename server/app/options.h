// The server's command line: built-in defaults < configuration file < environment (MAPLOC_...) <
// flag.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "server/app/tls_material.h"
#include "server/pipeline/localizer.h"
#include "server/recorder/query_recorder.h"
#include "server/service/request_log.h"

namespace maploc {

struct ServerOptions {
  std::string store;                       // path of the SQLite file; a missing one is created
  std::string listen = "127.0.0.1:50051";  // HOST:PORT; port 0 lets the system choose
  TlsFiles tls;                            // tls.cert empty: plain text
  bool insecure = false;                   // listens beyond loopback also without TLS or tokens
  std::string port_file;                   // empty: none
  std::string metrics_listen;              // HOST:PORT; empty: nobody can watch
  std::string log_level = "info";
  std::string log_format = "text";  // or json
  RequestLogOptions request_log;
  RecorderOptions recorder;
  int workers = 0;                 // localizations at the same time; 0: one a core
  int queue = 0;                   // waiting ones; 0: eight a worker
  double idle_timeout_s = 1800.0;  // 0: never
  std::int64_t cache_bytes = 0;    // of segments in memory; 0: half of MemoryLimit()
  LocalizerOptions localizer;
};

struct CommandLine {
  ServerOptions options;
  // Set where there is nothing to serve: help, version, --check-config, wrong usage.
  std::optional<int> exit_code;
};

// Prints help and what --check-config finds to standard output, errors to standard error. Exit
// codes: 2 wrong usage, 1 a configuration file that does not exist or cannot be used, 1 any fault
// that --check-config finds.
CommandLine ParseCommandLine(int argc, const char* const* argv);

}  // namespace maploc
