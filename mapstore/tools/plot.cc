#include <fstream>
#include <iostream>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"
#include "mapstore/tools/plot_svg.h"

namespace maploc {
namespace {

struct PlotFlags {
  std::string map;
  std::string out;
};

Status WriteFile(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (file) return Status::Ok();
  return Status(StatusCode::kUnavailable, "NOT_WRITTEN",
                path + ": cannot be written; check the folder and its permissions");
}

Status Plot(const CommandContext& context, const PlotFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, store->GetMap(flags.map));
  const MapKey& key = map.info.key;
  MAPLOC_ASSIGN_OR_RETURN(const auto segments, store->ListSegments(key));
  std::vector<std::shared_ptr<const Segment>> landmarks;
  for (const SegmentSummary& segment : segments) {
    MAPLOC_ASSIGN_OR_RETURN(auto loaded, store->LoadSegment(key, segment.id));
    landmarks.push_back(std::move(loaded));
  }
  const std::string title = key.name + ", version " + std::to_string(key.version);
  MAPLOC_RETURN_IF_ERROR(WriteFile(flags.out, PlotSvg(title, segments, landmarks)));
  if (context.json) {
    PrintJson({{"map", key.name}, {"out", flags.out}});
  } else {
    std::cout << "Drew " << segments.size() << " segments into " << flags.out << ".\n";
  }
  return Status::Ok();
}

}  // namespace

void AddPlotCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<PlotFlags>();
  CLI::App* command = AddCommand(
      app, context, "plot", "Draws a map's plan, its segments in the colours of their strategies",
      "maploc-map plot --store campus.db --map campus --out campus.svg",
      [&context, flags] { return Plot(context, *flags); });
  AddMapOption(*command, flags->map);
  command->add_option("--out", flags->out, "The picture's file")->required()->type_name("FILE.svg");
}

}  // namespace maploc
