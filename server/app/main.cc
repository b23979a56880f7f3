#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>

#include <absl/synchronization/mutex.h>
#include <google/protobuf/stubs/logging.h>
#include <spdlog/logger.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "mapstore/base/standard_output.h"
#include "server/app/log_sink.h"
#include "server/app/options.h"
#include "server/app/server.h"
#include "server/app/token_command.h"
#include "server/app/transport_limits.h"
#include "server/service/log_format.h"
#include "server/sessions/caught.h"

namespace {

// Under nohup it is; a signal that is blocked would be queued all the same, and end the server.
bool IsIgnored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

// Blocked before any thread starts, so that every thread leaves them to the waiting main thread.
// SIGHUP too: a terminal that closes ends the server as cleanly.
sigset_t BlockStopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT}) sigaddset(&signals, signal);
  if (!IsIgnored(SIGHUP)) sigaddset(&signals, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

// As a signal from outside would, for the waiting main thread.
void EndProcess() { kill(getpid(), SIGTERM); }

// Protobuf writes a line of its own to standard error for each string that is not UTF-8. Whoever
// sent it is told, and the log of requests has it.
void KeepProtobufSilent() { google::protobuf::SetLogHandler(nullptr); }

void OpenLog(const maploc::ServerOptions& options) {
  auto& file = maploc::LogFile::StandardError();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "maploc-server", maploc::NewLogSink(file, maploc::LostLines::kTold)));
  if (options.request_log.json) spdlog::set_formatter(maploc::JsonMessages());
  spdlog::set_level(spdlog::level::from_str(options.log_level));
  KeepProtobufSilent();
}

std::string LastLine(const maploc::Status& status) {
  return "maploc-server: " + status.message() + " (" + status.reason() + ")\n";
}

int Fail(const maploc::Status& status) {
  std::cerr << LastLine(status);
  return 1;
}

// The last line is for whoever started the server, or for a program that reads the log.
int FailWhileLogging(const maploc::Status& status, const maploc::ServerOptions& options) {
  if (options.request_log.json) {
    spdlog::critical("{} ({})", status.message(), status.reason());
  } else {
    // Not by the logger, whose level may hide it; and without waiting for a reader.
    maploc::LogFile::StandardError().Write(LastLine(status));
  }
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  maploc::OpenStandardFiles();
  if (maploc::IsTokenCommand(argc, argv)) return maploc::RunTokenCommand(argc, argv);
  const maploc::CommandLine command_line = maploc::ParseCommandLine(argc, argv);
  if (command_line.exit_code) {
    // Help and version are answers too, which may get lost.
    const maploc::Status printed = maploc::FlushStandardOutput();
    return *command_line.exit_code == 0 && !printed.ok() ? Fail(printed) : *command_line.exit_code;
  }
  OpenLog(command_line.options);

  // What gRPC has to say of a port in use, we say in one line; GRPC_VERBOSITY=debug brings it back.
  setenv("GRPC_VERBOSITY", "NONE", /*overwrite=*/0);
  // Whoever reads the log may go; that must not take the robots' server along.
  std::signal(SIGPIPE, SIG_IGN);
  // Nor a limit on the size of files: the write fails, and whoever waits for it is told.
  std::signal(SIGXFSZ, SIG_IGN);
  maploc::RaiseDescriptorLimit();
  // Debian builds Abseil so that each of gRPC's locks looks for deadlocks in a graph of all locks.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  const sigset_t signals = BlockStopSignals();
  auto server =
      maploc::Caught([&] { return maploc::Server::Start(command_line.options, EndProcess); });
  if (!server.ok()) return FailWhileLogging(server.status(), command_line.options);
  int signal = 0;
  sigwait(&signals, &signal);
  spdlog::info("{}: finishing what runs", strsignal(signal));
  const maploc::Status status = maploc::Caught([&] { return server.value()->Shutdown(); });
  server.value().reset();  // its threads may log; the last line is this one
  if (!status.ok()) return FailWhileLogging(status, command_line.options);
  spdlog::info("stopped; statistics are on disk");
  return 0;
}
