#include <filesystem>
#include <iostream>

#include "mapstore/base/clock.h"
#include "mapstore/store/sqlite_store.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/copy_map.h"
#include "mapstore/tools/deleted_versions.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct ImportFlags {
  std::string from;
  std::string map;  // empty: the file's only one
  Publishing publishing;
};

Result<MapInfo> ChooseMap(const MapStore& file, const ImportFlags& flags) {
  if (!flags.map.empty()) {
    MAPLOC_ASSIGN_OR_RETURN(MapSummary map, file.GetMap(flags.map));
    return std::move(map.info);
  }
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<MapSummary> maps, file.ListMaps());
  if (maps.size() == 1) return maps.front().info;
  return InvalidArgument(
      "from", "holds " + std::to_string(maps.size()) + " maps; name one of them with --map");
}

Status Import(const CommandContext& context, const ImportFlags& flags) {
  MAPLOC_RETURN_IF_ERROR(CheckFrom(flags.from));
  std::error_code none;
  // The import would change the store while it is being read.
  if (std::filesystem::equivalent(flags.from, context.store_path, none)) {
    return InvalidArgument("from", "is the store itself; name another one");
  }
  // Opened for writing, the file would be migrated and get a write-ahead log.
  SqliteStoreOptions source;
  source.create = false;
  source.read_only = true;
  MAPLOC_ASSIGN_OR_RETURN(const auto file, OpenSqliteStore(flags.from, source));
  MAPLOC_ASSIGN_OR_RETURN(MapInfo info, ChooseMap(*file, flags));
  const MapKey from = info.key;
  // The version is new in this store, however old it is in the file.
  info.created_unix_ns = SystemClock().NowUnixNanos();
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenOrCreateStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const auto before, store->ListVersions());
  MAPLOC_ASSIGN_OR_RETURN(const MapKey key, CopyMap(*file, from, *store, info, flags.publishing,
                                                    [](const Segment& s) { return s; }));
  MAPLOC_ASSIGN_OR_RETURN(const auto deleted, DeletedSince(before, *store, key.name));
  if (context.json) {
    PrintJson({{"map", key.name},
               {"version", key.version},
               {"from", flags.from},
               {"deleted_versions", deleted}});
  } else {
    std::cout << "Map " << key.name << " version " << key.version << " is version " << from.version
              << " of " << flags.from << ".\n";
    PrintDeleted(deleted);
  }
  return Status::Ok();
}

}  // namespace

void AddImportCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<ImportFlags>();
  CLI::App* command = AddCommand(
      app, context, "import", "Takes a map out of a file that `export` wrote, or of another store",
      "maploc-map import --store campus.db --from yard.maploc\n"
      "The map comes as a new version of its name, and inherits what the sessions of the version "
      "before taught.",
      [&context, flags] { return Import(context, *flags); });
  command->add_option("--from", flags->from, "The file; a store with this map. It stays as it is")
      ->required()
      ->type_name("FILE");
  command->add_option("--map", flags->map, "Which map, where the file holds several")
      ->type_name("NAME");
  AddPublishingFlags(*command, flags->publishing);
}

}  // namespace maploc
