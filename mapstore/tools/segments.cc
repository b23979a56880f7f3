#include <iostream>

#include "mapstore/base/table.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

nlohmann::ordered_json ToJson(const SegmentSummary& segment) {
  const SegmentStatistics& statistics = segment.statistics;
  return {{"segment", segment.id},
          {"points", segment.points},
          {"lines", segment.lines},
          {"usable_lines", segment.usable_lines},
          {"strategy", StrategyName(segment.decision.strategy)},
          {"strategy_source", StrategySourceName(segment.decision.source)},
          {"point_inlier_ratio", JsonRatio(statistics.PointInlierRatio())},
          {"line_inlier_ratio", JsonRatio(statistics.LineInlierRatio())},
          {"sessions", statistics.sessions},
          {"queries", statistics.queries},
          {"localized", statistics.localized}};
}

void PrintTable(const std::vector<SegmentSummary>& segments) {
  Table table({"segment", "points", "lines", "usable", "strategy", "source", "point inliers",
               "line inliers", "sessions", "queries", "localized"});
  for (const SegmentSummary& segment : segments) {
    const SegmentStatistics& statistics = segment.statistics;
    table.AddRow({std::to_string(segment.id), std::to_string(segment.points),
                  std::to_string(segment.lines), std::to_string(segment.usable_lines),
                  std::string(StrategyName(segment.decision.strategy)),
                  std::string(StrategySourceName(segment.decision.source)),
                  FormatRatio(statistics.PointInlierRatio()),
                  FormatRatio(statistics.LineInlierRatio()), std::to_string(statistics.sessions),
                  std::to_string(statistics.queries), std::to_string(statistics.localized)});
  }
  table.Print(std::cout);
}

Status Segments(const CommandContext& context, const std::string& name) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, store->GetMap(name));
  MAPLOC_ASSIGN_OR_RETURN(const auto segments, store->ListSegments(map.info.key));
  if (!context.json) return PrintTable(segments), Status::Ok();
  auto document = nlohmann::ordered_json::array();
  for (const SegmentSummary& segment : segments) document.push_back(ToJson(segment));
  PrintJson(document);
  return Status::Ok();
}

}  // namespace

void AddSegmentsCommand(CLI::App& app, CommandContext& context) {
  auto name = std::make_shared<std::string>();
  CLI::App* command =
      AddCommand(app, context, "segments", "Lists a map's segments with what sessions taught",
                 "maploc-map segments --store campus.db --map campus",
                 [&context, name] { return Segments(context, *name); });
  AddMapOption(*command, *name);
}

}  // namespace maploc
