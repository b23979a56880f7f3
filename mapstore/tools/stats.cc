#include <iostream>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct StatsFlags {
  std::string map;
  bool recompute = false;
};

nlohmann::ordered_json ToJson(const SegmentSummary& segment, bool recomputed) {
  const SegmentStatistics& statistics = segment.statistics;
  nlohmann::ordered_json json = {
      {"segment", segment.id},
      {"sessions", statistics.sessions},
      {"queries", statistics.queries},
      {"localized", statistics.localized},
      {"point_inlier_ratio", JsonRatio(statistics.PointInlierRatio())},
      {"line_inlier_ratio", JsonRatio(statistics.LineInlierRatio())},
      {"point_matches", statistics.point_matches},
      {"point_inliers", statistics.point_inliers},
      {"usable_line_matches", statistics.usable_line_matches},
      {"usable_line_inliers", statistics.usable_line_inliers},
      {"vertical_line_matches", statistics.vertical_line_matches},
      {"vertical_line_inliers", statistics.vertical_line_inliers},
      {"typical_point_matches", statistics.typical_point_matches},
      {"typical_usable_line_matches", statistics.typical_usable_line_matches},
      {"typical_vertical_line_matches", statistics.typical_vertical_line_matches}};
  if (recomputed) json["recomputed_equal"] = true;
  return json;
}

void PrintTable(const std::vector<SegmentSummary>& segments) {
  Table table({"segment", "sessions", "queries", "localized", "point inliers / matches",
               "usable line inliers / matches", "vertical line inliers / matches", "p", "l", "lv"});
  const auto pair = [](double inliers, double matches) {
    return FormatNumber(inliers, 1) + " / " + FormatNumber(matches, 1);
  };
  for (const SegmentSummary& segment : segments) {
    const SegmentStatistics& s = segment.statistics;
    table.AddRow({std::to_string(segment.id), std::to_string(s.sessions), std::to_string(s.queries),
                  std::to_string(s.localized), pair(s.point_inliers, s.point_matches),
                  pair(s.usable_line_inliers, s.usable_line_matches),
                  pair(s.vertical_line_inliers, s.vertical_line_matches),
                  FormatNumber(s.typical_point_matches, 1),
                  FormatNumber(s.typical_usable_line_matches, 1),
                  FormatNumber(s.typical_vertical_line_matches, 1)});
  }
  table.Print(std::cout);
}

// From the rows of the sessions, with the options that the stored statistics were derived with.
Status CheckRecomputed(const MapStore& store, const MapKey& key, const SegmentSummary& segment) {
  MAPLOC_ASSIGN_OR_RETURN(const auto rows, store.ListRows(key, segment.id));
  if (Aggregate(rows, segment.selector.statistics) == segment.statistics) return Status::Ok();
  return Status(StatusCode::kDataLoss, "DAMAGED_STORE",
                "segment " + std::to_string(segment.id) +
                    ": its statistics differ from its sessions' rows; restore the store from a "
                    "backup");
}

Status Stats(const CommandContext& context, const StatsFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, store->GetMap(flags.map));
  MAPLOC_ASSIGN_OR_RETURN(const auto segments, store->ListSegments(map.info.key));
  auto document = nlohmann::ordered_json::array();
  for (const SegmentSummary& segment : segments) {
    if (flags.recompute) {
      MAPLOC_RETURN_IF_ERROR(CheckRecomputed(*store, map.info.key, segment));
    }
    document.push_back(ToJson(segment, flags.recompute));
  }
  if (context.json) return PrintJson(document), Status::Ok();
  PrintTable(segments);
  if (flags.recompute) {
    std::cout << "Recomputed from the sessions' rows: equal to the bit in all " << segments.size()
              << " segments.\n";
  }
  return Status::Ok();
}

}  // namespace

void AddStatsCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<StatsFlags>();
  CLI::App* command =
      AddCommand(app, context, "stats", "Shows the sums that a map's strategies are chosen from",
                 "maploc-map stats --store campus.db --map campus --recompute",
                 [&context, flags] { return Stats(context, *flags); });
  AddMapOption(*command, flags->map);
  command->add_flag("--recompute", flags->recompute,
                    "Derive them anew from the sessions' rows and compare to the bit");
}

}  // namespace maploc
