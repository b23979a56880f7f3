#include <iostream>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/deleted_versions.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct EnableFlags {
  std::string map;
  std::int64_t version = 0;
  KeptVersions keep;
};

// The enabled version of a map; 0: none is.
Result<std::int64_t> EnabledVersion(const std::vector<MapSummary>& versions,
                                    const std::string& name) {
  bool known = false;
  for (const MapSummary& map : versions) {
    if (map.info.key.name != name) continue;
    if (map.enabled) return map.info.key.version;
    known = true;
  }
  if (known) return 0;
  return NotFound("map '" + name + "'", "MAP_NOT_FOUND");
}

void Report(const CommandContext& context, const MapKey& key, std::int64_t before,
            const std::vector<std::int64_t>& deleted) {
  if (context.json) {
    PrintJson({{"map", key.name},
               {"version", key.version},
               {"version_before", before},
               {"changed", key.version != before},
               {"deleted_versions", deleted}});
    return;
  }
  if (key.version == before) {
    std::cout << "Map " << key.name << " version " << key.version << " is enabled already.\n";
  } else {
    std::cout << "Map " << key.name << " version " << key.version << " is enabled";
    if (before > 0) std::cout << ", version " << before << " no longer is";
    std::cout << ".\n";
  }
  PrintDeleted(deleted);
}

Status Enable(const CommandContext& context, const EnableFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<MapSummary> versions, store->ListVersions());
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t before, EnabledVersion(versions, flags.map));
  const MapKey key{flags.map, flags.version};
  MAPLOC_RETURN_IF_ERROR(store->EnableVersion(key, flags.keep));
  MAPLOC_ASSIGN_OR_RETURN(const auto deleted, DeletedSince(versions, *store, flags.map));
  return Report(context, key, before, deleted), Status::Ok();
}

// The version that was enabled before the one that is.
Result<MapKey> VersionBefore(const std::vector<MapSummary>& versions, const std::string& name) {
  const MapSummary* before = nullptr;
  for (const MapSummary& map : versions) {
    // enabled_order rises with each version that is enabled, so the largest of the others came
    // last.
    if (map.info.key.name != name || map.enabled || map.enabled_order == 0) continue;
    if (before == nullptr || map.enabled_order > before->enabled_order) before = &map;
  }
  if (before != nullptr) return before->info.key;
  return FailedPrecondition("NO_VERSION_BEFORE",
                            "map '" + name +
                                "' has no other version that was enabled before; "
                                "`versions` lists those that `enable` takes");
}

Status Rollback(const CommandContext& context, const std::string& name) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<MapSummary> versions, store->ListVersions());
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t before, EnabledVersion(versions, name));
  MAPLOC_ASSIGN_OR_RETURN(const MapKey key, VersionBefore(versions, name));
  // Deletes nothing: a rollback may itself be taken back.
  MAPLOC_RETURN_IF_ERROR(store->EnableVersion(key));
  return Report(context, key, before, {}), Status::Ok();
}

}  // namespace

void AddEnableCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<EnableFlags>();
  CLI::App* command = AddCommand(
      app, context, "enable", "Chooses the version of a map that robots get",
      "maploc-map enable --store campus.db --map yard --version 3\n"
      "A running server follows within a second, after it has loaded the version. Open sessions "
      "stay on theirs.",
      [&context, flags] { return Enable(context, *flags); });
  AddMapOption(*command, flags->map);
  AddRequiredVersionOption(*command, flags->version);
  AddKeepVersionsOption(*command, flags->keep);
}

void AddRollbackCommand(CLI::App& app, CommandContext& context) {
  auto map = std::make_shared<std::string>();
  CLI::App* command = AddCommand(
      app, context, "rollback", "Enables the version of a map that was enabled before",
      "maploc-map rollback --store campus.db --map yard\n"
      "Said twice, it goes there and back. What sessions taught the version that goes stays "
      "with it.",
      [&context, map] { return Rollback(context, *map); });
  AddMapOption(*command, *map);
}

}  // namespace maploc
