#include <iostream>
#include <map>
#include <optional>

#include "mapstore/base/table.h"
#include "mapstore/base/text.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/decline.h"
#include "mapstore/tools/fleet.h"
#include "mapstore/tools/lean_warning.h"
#include "mapstore/tools/output.h"
#include "mapstore/tools/session_groups.h"

namespace maploc {
namespace {

struct StatsFlags {
  std::string map;
  std::optional<std::int64_t> version;  // else the enabled one
  GroupOptions groups;
};

nlohmann::ordered_json ToJson(const SegmentStats& stats, bool recomputed) {
  const SegmentSummary& segment = stats.summary;
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
      {"typical_vertical_line_matches", statistics.typical_vertical_line_matches},
      {"inherited_sessions", stats.inherited_sessions},
      {"changes", ToJson(stats.changes)}};
  if (recomputed) json["recomputed_equal"] = true;
  return json;
}

void PrintTable(const std::vector<SegmentStats>& segments) {
  Table table({"segment", "sessions", "queries", "localized", "point inliers / matches",
               "usable line inliers / matches", "vertical line inliers / matches", "p", "l", "lv"});
  const auto pair = [](double inliers, double matches) {
    return FixedText(inliers, 1) + " / " + FixedText(matches, 1);
  };
  for (const SegmentStats& segment : segments) {
    const SegmentStatistics& s = segment.summary.statistics;
    table.AddRow(
        {std::to_string(segment.summary.id), std::to_string(s.sessions), std::to_string(s.queries),
         std::to_string(s.localized), pair(s.point_inliers, s.point_matches),
         pair(s.usable_line_inliers, s.usable_line_matches),
         pair(s.vertical_line_inliers, s.vertical_line_matches),
         FixedText(s.typical_point_matches, 1), FixedText(s.typical_usable_line_matches, 1),
         FixedText(s.typical_vertical_line_matches, 1)});
  }
  table.Print(std::cout);
}

// The declines in the order of their rank, which programs find in each segment's "decline_rank".
std::vector<Decline> DeclinesOf(const std::vector<SegmentStats>& segments) {
  std::vector<SegmentChanges> changes;
  for (const SegmentStats& stats : segments) changes.push_back({stats.summary.id, stats.changes});
  return RankDeclines(changes);
}

nlohmann::ordered_json ToJson(const std::vector<SegmentStats>& segments, bool recomputed) {
  std::map<SegmentId, int> ranks;
  for (const Decline& decline : DeclinesOf(segments)) {
    ranks.try_emplace(decline.segment, static_cast<int>(ranks.size()) + 1);
  }
  auto document = nlohmann::ordered_json::array();
  for (const SegmentStats& stats : segments) {
    document.push_back(ToJson(stats, recomputed));
    const auto rank = ranks.find(stats.summary.id);
    document.back()["decline_rank"] = rank == ranks.end() ? nlohmann::ordered_json(nullptr)
                                                          : nlohmann::ordered_json(rank->second);
  }
  return document;
}

void PrintJsonOf(const std::vector<SessionGroup>& groups, const GroupOptions& options) {
  if (options.by.empty()) return PrintJson(ToJson(groups.front().segments, options.recompute));
  auto document = nlohmann::ordered_json::array();
  for (const SessionGroup& group : groups) {
    document.push_back({{"by", options.by},
                        {"value", group.value ? nlohmann::ordered_json(*group.value)
                                              : nlohmann::ordered_json(nullptr)},
                        {"segments", ToJson(group.segments, options.recompute)}});
  }
  PrintJson(document);
}

void PrintText(const std::vector<SessionGroup>& groups, const GroupOptions& options) {
  for (const SessionGroup& group : groups) {
    if (!options.by.empty()) {
      std::cout << (group.value ? options.by + "=" + *group.value : "without " + options.by)
                << "\n";
    }
    PrintTable(group.segments);
    std::cout << "p, l, lv: what a query typically has of matches with points, with usable and "
                 "with vertical lines.\n";
    PrintDeclines(DeclinesOf(group.segments));
    std::cout << "\n";
  }
  if (options.recompute) {
    std::cout << "Recomputed from the sessions' rows: equal to the bit in all segments.\n";
  }
}

Status Stats(const CommandContext& context, const StatsFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, FindMap(*store, flags.map, flags.version));
  MAPLOC_ASSIGN_OR_RETURN(const auto groups, ReadGroups(*store, map.info.key, flags.groups));
  // All sessions of the version, whatever --label chose: a lean is the map's, and all robots see
  // it.
  MAPLOC_ASSIGN_OR_RETURN(const auto sessions, ReadSessions(*store, map.info.key));
  for (const std::string& lean : DescribeLeans(sessions)) std::cerr << lean << "\n";
  context.json ? PrintJsonOf(groups, flags.groups) : PrintText(groups, flags.groups);
  return Status::Ok();
}

}  // namespace

void AddStatsCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<StatsFlags>();
  CLI::App* command = AddCommand(
      app, context, "stats",
      "Shows the sums that a map's strategies are chosen from; says whether the robots' gravity "
      "finds it leaning",
      "maploc-map stats --store campus.db --map campus --recompute\n"
      "  maploc-map stats --store campus.db --map campus --label season=autumn --by light",
      [&context, flags] { return Stats(context, *flags); });
  AddMapOption(*command, flags->map);
  AddVersionOption(*command, flags->version);
  // Without allow_extra_args(false) CLI11 takes the words after a label as further labels.
  command
      ->add_option("--label", flags->groups.labels,
                   "Only sessions with this label (repeatable: with all)")
      ->check(CLI::Validator(
          [](const std::string& label) {
            const std::size_t split = label.find('=');
            const bool good = split != std::string::npos && split > 0;
            return good ? std::string() : "a label is KEY=VALUE, not '" + label + "'";
          },
          "KEY=VALUE", "label"))
      ->allow_extra_args(false);
  command->add_option("--by", flags->groups.by, "One table for each value of this label")
      ->type_name("KEY");
  command->add_flag("--recompute", flags->groups.recompute,
                    "Recompute from the sessions' rows and compare bit by bit");
}

}  // namespace maploc
