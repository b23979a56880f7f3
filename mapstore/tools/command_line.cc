#include <charconv>
#include <filesystem>

#include "mapstore/store/sqlite_store.h"
#include "mapstore/tools/commands.h"

namespace maploc {
namespace {

Result<std::unique_ptr<MapStore>> OpenStore(const CommandContext& context, bool create) {
  SqliteStoreOptions options;
  options.create = create;
  return OpenSqliteStore(context.store_path, options);
}

// CLI11 would take what is beyond 64 bits for their largest number.
std::string CheckVersion(const std::string& text) {
  std::int64_t version = 0;
  const char* const end = text.data() + text.size();
  const auto [parsed, error] = std::from_chars(text.data(), end, version);
  const bool good = error == std::errc() && parsed == end && version > 0;
  return good ? "" : "must be a whole number, 1 or more, got '" + text + "'";
}

}  // namespace

CLI::App* AddCommand(CLI::App& app, CommandContext& context, const std::string& name,
                     const std::string& description, const std::string& example,
                     std::function<Status()> run) {
  CLI::App* command = app.add_subcommand(name, description);
  command->footer("Example:\n  " + example);
  command->add_option("--store", context.store_path, "The store's file")
      ->required()
      ->type_name("FILE");
  command->add_flag("--json", context.json, "One JSON document on standard output");
  // CLI11 calls this while it parses. The work itself waits, so that its failure (exit code 1) is
  // not taken for wrong usage (2).
  command->callback([&context, run = std::move(run)] { context.chosen = run; });
  return command;
}

void AddMapOption(CLI::App& command, std::string& name) {
  command.add_option("--map", name, "The map's name")->required()->type_name("NAME");
}

void AddSegmentOption(CLI::App& command, SegmentId& segment) {
  command.add_option("--segment", segment, "The segment, as `segments` lists them")
      ->required()
      ->type_name("ID");
}

void AddVersionOption(CLI::App& command, std::optional<std::int64_t>& version) {
  command.add_option("--version", version, "The map's version; left out: the enabled one")
      ->type_name("N");
}

void AddRequiredVersionOption(CLI::App& command, std::int64_t& version) {
  command.add_option("--version", version, "The version, as `versions` lists them")
      ->required()
      ->check(CheckVersion)
      ->type_name("N");
}

void AddKeepVersionsOption(CLI::App& command, KeptVersions& keep) {
  command
      .add_option("--keep-versions", keep,
                  "Of the DISABLED versions older than the enabled one keep so many, those that "
                  "were enabled last; delete the others, unless open sessions use them. Left out: "
                  "keep all")
      ->check(CLI::Range(0, 1000000))
      ->type_name("N");
}

void AddPublishingFlags(CLI::App& command, Publishing& publishing) {
  command.add_flag_callback(
      "--stage", [&publishing] { publishing.enable = false; },
      "Leave the new version DISABLED until `maploc-map enable`; robots keep theirs");
  AddKeepVersionsOption(command, publishing.keep_versions);
}

Result<MapSummary> FindMap(const MapStore& store, const std::string& name,
                           std::optional<std::int64_t> version) {
  if (!version) return store.GetMap(name);
  // A number that parses but makes no sense is a failure (exit code 1), not wrong usage (2).
  if (*version < 1) return InvalidArgument("version", "must be 1 or more");
  return store.GetMap(MapKey{name, *version});
}

Status CheckFrom(const std::string& from) {
  // Asked here, because whoever reads the file as a store would name --store in the cure.
  std::error_code error;
  if (std::filesystem::exists(from, error)) return Status::Ok();
  return Status(StatusCode::kNotFound, "FILE_NOT_FOUND",
                from + ": there is no such file; check --from");
}

Result<std::unique_ptr<MapStore>> OpenExistingStore(const CommandContext& context) {
  return OpenStore(context, false);
}

Result<std::unique_ptr<MapStore>> OpenOrCreateStore(const CommandContext& context) {
  return OpenStore(context, true);
}

}  // namespace maploc
