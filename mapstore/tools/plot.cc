#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"
#include "mapstore/tools/plot_svg.h"
#include "mapstore/tools/readings.h"

namespace maploc {
namespace {

struct PlotFlags {
  std::string map;
  std::optional<std::int64_t> version;  // else the enabled one
  std::string out;
  std::string colour = "strategy";
};

PlotColour ColourFromName(const std::string& name) {
  if (name == "inlier-ratio") return PlotColour::kInlierRatio;
  return name == "change" ? PlotColour::kChange : PlotColour::kStrategy;
}

Status WriteFile(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  // Closed before the check, because a full disk shows only when the buffer is written.
  file.close();
  if (file) return Status::Ok();
  return Status(StatusCode::kUnavailable, "NOT_WRITTEN",
                path + ": cannot be written; check the folder and its permissions");
}

Status Plot(const CommandContext& context, const PlotFlags& flags) {
  if (std::filesystem::path(flags.out).extension() != ".svg") {
    return InvalidArgument("--out",
                           "'" + flags.out +
                               "' must end in .svg, the only kind of picture that is "
                               "drawn; browsers show it, and rsvg-convert makes a PNG of it");
  }
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const ChangedMap changed, ReadChanged(*store, flags.map, flags.version));
  const MapKey& key = changed.map;
  // Read apart from the statistics, because the landmarks of a version never change.
  std::vector<std::shared_ptr<const Segment>> landmarks;
  for (const SegmentSummary& segment : changed.segments) {
    MAPLOC_ASSIGN_OR_RETURN(auto loaded, store->LoadSegment(key, segment.id));
    landmarks.push_back(std::move(loaded));
  }
  const std::string title =
      key.name + ", version " + std::to_string(key.version) + ", segments by " + flags.colour;
  MAPLOC_RETURN_IF_ERROR(WriteFile(
      flags.out,
      PlotSvg(title, ColourFromName(flags.colour), changed.segments, changed.changes, landmarks)));
  if (context.json) {
    PrintJson({{"map", key.name}, {"out", flags.out}});
  } else {
    std::cout << "Drew " << changed.segments.size() << " segments into " << flags.out << ".\n";
  }
  return Status::Ok();
}

}  // namespace

void AddPlotCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<PlotFlags>();
  CLI::App* command = AddCommand(
      app, context, "plot", "Draws a map's plan, its segments coloured by what is known of them",
      "maploc-map plot --store campus.db --map campus --out campus.svg --colour change",
      [&context, flags] { return Plot(context, *flags); });
  AddMapOption(*command, flags->map);
  AddVersionOption(*command, flags->version);
  command->add_option("--out", flags->out, "The picture's file, an SVG")
      ->required()
      ->type_name("FILE.svg");
  command->add_option("--colour", flags->colour, "What the colours show")
      ->check(CLI::IsMember({"strategy", "inlier-ratio", "change"}))
      ->capture_default_str();
}

}  // namespace maploc
