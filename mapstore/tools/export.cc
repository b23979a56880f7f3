#include <iostream>

#include <unistd.h>

#include "mapstore/store/sqlite_store.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/copy_map.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct ExportFlags {
  std::string map;
  std::optional<std::int64_t> version;  // else the enabled one
  std::string to;
};

// A store of one map. It closes before its file is given its name, so that no log stays beside it.
Result<MapKey> WriteFile(const MapStore& store, const MapInfo& info, const std::string& file) {
  MAPLOC_ASSIGN_OR_RETURN(const std::unique_ptr<MapStore> target, OpenSqliteStore(file));
  return CopyMap(store, info.key, *target, info, {},
                 [](const Segment& segment) { return segment; });
}

Status ExportTo(const MapStore& store, const MapInfo& info, const std::string& to) {
  // Checked first, so that the error names the path that the user gave and not that of the partial
  // file.
  MAPLOC_RETURN_IF_ERROR(CheckNewStoreFile(to));
  // With the process's id, so that two exports do not write to one file.
  const std::string partial = to + ".partial-" + std::to_string(getpid());
  Status status = WriteFile(store, info, partial).status();
  if (status.ok()) status = PublishStoreFile(partial, to);
  // After a success, too: nothing of the work stays beside the new file.
  RemoveStoreFiles(partial);
  return status;
}

Status Export(const CommandContext& context, const ExportFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, FindMap(*store, flags.map, flags.version));
  MAPLOC_RETURN_IF_ERROR(ExportTo(*store, map.info, flags.to));
  if (context.json) {
    PrintJson({{"map", map.info.key.name}, {"version", map.info.key.version}, {"to", flags.to}});
  } else {
    std::cout << "Copied map " << map.info.key.name << " version " << map.info.key.version << " to "
              << flags.to << ".\n";
  }
  return Status::Ok();
}

}  // namespace

void AddExportCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<ExportFlags>();
  CLI::App* command = AddCommand(
      app, context, "export", "Copies one map's landmarks to a file, for another store",
      "maploc-map export --store campus.db --map yard --to yard.maploc\n"
      "The file is a store of this map alone. Sessions and their statistics stay behind; `backup` "
      "takes them along.",
      [&context, flags] { return Export(context, *flags); });
  AddMapOption(*command, flags->map);
  AddVersionOption(*command, flags->version);
  command->add_option("--to", flags->to, "The new file; must not exist")
      ->required()
      ->type_name("FILE");
}

}  // namespace maploc
