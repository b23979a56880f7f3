#include <algorithm>
#include <iostream>

#include "mapstore/base/table.h"
#include "mapstore/base/text.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

std::string_view StateName(const MapSummary& map) { return map.enabled ? "ENABLED" : "DISABLED"; }

nlohmann::ordered_json ToJson(const MapSummary& map) {
  return {{"map", map.info.key.name}, {"version", map.info.key.version},
          {"state", StateName(map)},  {"created_unix_ns", map.info.created_unix_ns},
          {"segments", map.segments}, {"points", map.points},
          {"lines", map.lines}};
}

void PrintTable(const std::vector<MapSummary>& versions) {
  Table table({"map", "version", "state", "created", "segments", "points", "lines"});
  for (const MapSummary& map : versions) {
    table.AddRow({map.info.key.name, std::to_string(map.info.key.version),
                  std::string(StateName(map)), UtcText(map.info.created_unix_ns),
                  std::to_string(map.segments), std::to_string(map.points),
                  std::to_string(map.lines)});
  }
  table.Print(std::cout);
}

Status List(const CommandContext& context, const std::string& name) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(std::vector<MapSummary> versions, store->ListVersions());
  if (!name.empty()) {
    std::erase_if(versions, [&](const MapSummary& map) { return map.info.key.name != name; });
    if (versions.empty()) return store->GetMap(name).status();  // unknown
  }
  if (!context.json) return PrintTable(versions), Status::Ok();
  auto document = nlohmann::ordered_json::array();
  for (const MapSummary& map : versions) document.push_back(ToJson(map));
  PrintJson(document);
  return Status::Ok();
}

}  // namespace

void AddVersionsCommand(CLI::App& app, CommandContext& context) {
  auto map = std::make_shared<std::string>();
  CLI::App* command = AddCommand(
      app, context, "versions", "Lists every version of the maps, and which one robots get",
      "maploc-map versions --store campus.db --map yard\n"
      "One version of a map is ENABLED: new sessions and queries outside of sessions get it.",
      [&context, map] { return List(context, *map); });
  command->add_option("--map", *map, "Of one map; left out: of all")->type_name("NAME");
}

}  // namespace maploc
