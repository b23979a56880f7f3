// maploc's commands: one file a command, each declared here and added to the command line by
// main.cc. A command parses its flags with CLI11 and leaves its work in the context; main runs it
// and turns its Status into the exit code (0 done, 1 failed; wrong usage is 2, by CLI11).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/api/client.h"
#include "client/api/credentials.h"
#include "mapstore/base/status.h"

namespace maploc {

// What every command shares. Lives as long as the command line's parser.
struct CommandContext {
  std::string server;              // --server HOST:PORT
  CredentialFiles credentials;     // --ca, --cert, --key, --token-file
  double timeout_s = 10.0;         // --timeout: of each call
  bool json = false;               // --json: one document on standard output, all else on error
  std::function<Status()> chosen;  // the chosen command's work; set by the parser
};

// Adds a subcommand with --json; `run` is its work. `example` is one command line or more, shown by
// --help. The caller adds its own flags, bound to variables that outlive the parser (a shared_ptr
// captured by `run`).
CLI::App* AddCommand(CLI::App& app, CommandContext& context, const std::string& name,
                     const std::string& description, const std::string& example,
                     std::function<Status()> run);

// --server, which every command but the making of a world needs, --timeout, and what the server
// asks for: --ca, --cert, --key, --token-file.
CLI::Option* AddServerFlag(CLI::App& command, CommandContext& context);

// What --timeout and the credentials' flags ask for, and MAPLOC_TOKEN of the environment where
// there is no --token-file; never a bare argument, which every process of the machine could read.
// INVALID_ARGUMENT where it makes no sense.
Result<ClientOptions> ClientOptionsFrom(const CommandContext& context);
// A client of --server.
Result<Client> Connect(const CommandContext& context);

// "note: ..." on standard error.
void PrintNotes(const std::vector<std::string>& notes);

// INVALID_ARGUMENT unless `value`, of the flag named, is in [least, most]; a NaN is in no range.
// For the command's work: a value that parses but makes no sense is a failure, not wrong usage.
Status CheckRange(const char* flag, double value, double least, double most);

void AddLocalizeCommand(CLI::App& app, CommandContext& context);
void AddReplayCommand(CLI::App& app, CommandContext& context);
void AddEndSessionCommand(CLI::App& app, CommandContext& context);
void AddLoadCommand(CLI::App& app, CommandContext& context);
void AddSimulateCommand(CLI::App& app, CommandContext& context);

}  // namespace maploc
