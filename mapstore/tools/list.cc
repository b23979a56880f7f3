#include <iostream>

#include "mapstore/base/table.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

nlohmann::ordered_json ToJson(const MapSummary& map) {
  return {{"map", map.info.key.name},
          {"version", map.info.key.version},
          {"metric", map.info.metric},
          {"segments", map.segments},
          {"points", map.points},
          {"lines", map.lines},
          {"usable_lines", map.usable_lines},
          {"point_descriptor", map.info.point_descriptor.name},
          {"line_descriptor", map.info.line_descriptor.name}};
}

void PrintTable(const std::vector<MapSummary>& maps) {
  Table table(
      {"map", "version", "unit", "segments", "points", "lines", "usable lines", "descriptors"});
  for (const MapSummary& map : maps) {
    const std::string& lines = map.info.line_descriptor.name;
    table.AddRow({map.info.key.name, std::to_string(map.info.key.version),
                  map.info.metric ? "metres" : "unknown", std::to_string(map.segments),
                  std::to_string(map.points), std::to_string(map.lines),
                  std::to_string(map.usable_lines),
                  map.info.point_descriptor.name + (lines.empty() ? "" : ", " + lines)});
  }
  table.Print(std::cout);
}

Status List(const CommandContext& context) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const auto maps, store->ListMaps());
  if (!context.json) return PrintTable(maps), Status::Ok();
  auto document = nlohmann::ordered_json::array();
  for (const MapSummary& map : maps) document.push_back(ToJson(map));
  PrintJson(document);
  return Status::Ok();
}

}  // namespace

void AddListCommand(CLI::App& app, CommandContext& context) {
  AddCommand(app, context, "list", "Lists the maps, enabled version of each",
             "maploc-map list --store campus.db", [&context] { return List(context); });
}

}  // namespace maploc
