// maploc-map's commands: one file a command, each declared here and added to the command line by
// main.cc. A command parses its flags with CLI11 and leaves what is to be done in the context; main
// runs it and turns its Status into the exit code (0 done, 1 failed; wrong usage is 2, by CLI11).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "mapstore/base/status.h"
#include "mapstore/store/map_store.h"

namespace maploc {

// What every command shares. Lives as long as the command line's parser.
struct CommandContext {
  std::string store_path;          // --store
  bool json = false;               // --json: one document on standard output, all else on error
  std::function<Status()> chosen;  // the chosen command's work; set by the parser
};

// Adds a subcommand with --store and --json; `run` is its work. `example` is one command line or
// more, shown by --help. The caller adds its own flags to what is returned, bound to variables that
// outlive the parser (a shared_ptr captured by `run`).
CLI::App* AddCommand(CLI::App& app, CommandContext& context, const std::string& name,
                     const std::string& description, const std::string& example,
                     std::function<Status()> run);

// The flags that many commands have.
void AddMapOption(CLI::App& command, std::string& name);       // --map, required
void AddSegmentOption(CLI::App& command, SegmentId& segment);  // --segment, required

void AddVersionOption(CLI::App& command, std::optional<std::int64_t>& version);  // --version
void AddRequiredVersionOption(CLI::App& command, std::int64_t& version);  // the same, required
void AddKeepVersionsOption(CLI::App& command, KeptVersions& keep);        // --keep-versions
void AddPublishingFlags(CLI::App& command, Publishing& publishing);       // and --stage

// One version of a map, the enabled one where none is given. INVALID_ARGUMENT: below 1.
Result<MapSummary> FindMap(const MapStore& store, const std::string& name,
                           std::optional<std::int64_t> version);

// NOT_FOUND with the cure where --from names no file; what else it must be is told by its reader.
Status CheckFrom(const std::string& from);

// The store at context.store_path, which must exist: a command that reads makes none.
Result<std::unique_ptr<MapStore>> OpenExistingStore(const CommandContext& context);
// The same, but created where it does not exist (for imports).
Result<std::unique_ptr<MapStore>> OpenOrCreateStore(const CommandContext& context);

void AddListCommand(CLI::App& app, CommandContext& context);
void AddVersionsCommand(CLI::App& app, CommandContext& context);
void AddEnableCommand(CLI::App& app, CommandContext& context);
void AddRollbackCommand(CLI::App& app, CommandContext& context);
void AddDeleteCommand(CLI::App& app, CommandContext& context);
void AddSegmentsCommand(CLI::App& app, CommandContext& context);
void AddStatsCommand(CLI::App& app, CommandContext& context);
void AddStrategyCommand(CLI::App& app, CommandContext& context);
void AddExplainCommand(CLI::App& app, CommandContext& context);
void AddRobotsCommand(CLI::App& app, CommandContext& context);
void AddSessionsCommand(CLI::App& app, CommandContext& context);
void AddRevokeCommand(CLI::App& app, CommandContext& context);
void AddVerifyCommand(CLI::App& app, CommandContext& context);
void AddLevelCommand(CLI::App& app, CommandContext& context);
void AddExportCommand(CLI::App& app, CommandContext& context);
void AddImportCommand(CLI::App& app, CommandContext& context);
void AddBackupCommand(CLI::App& app, CommandContext& context);
void AddPlotCommand(CLI::App& app, CommandContext& context);

}  // namespace maploc
