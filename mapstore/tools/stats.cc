#include <algorithm>
#include <iostream>
#include <map>
#include <optional>

#include "mapstore/statistics/change.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/decline.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct StatsFlags {
  std::string map;
  std::optional<std::int64_t> version;  // else the newest
  bool recompute = false;
  std::vector<std::string> labels;  // KEY=VALUE, all of which a session must have
  std::string by;                   // a label's key, or empty
};

// The sums over some of a map's sessions, with when they changed.
struct SegmentStats {
  SegmentSummary summary;
  std::vector<ChangePoint> changes;
  std::int64_t inherited_sessions = 0;  // of older versions
};

// The sessions that have one value of a label, or all of them.
struct Group {
  std::optional<std::string> value;  // nullopt: those without the label, or all
  std::vector<SegmentStats> segments;
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
    return FormatNumber(inliers, 1) + " / " + FormatNumber(matches, 1);
  };
  for (const SegmentStats& segment : segments) {
    const SegmentStatistics& s = segment.summary.statistics;
    table.AddRow(
        {std::to_string(segment.summary.id), std::to_string(s.sessions), std::to_string(s.queries),
         std::to_string(s.localized), pair(s.point_inliers, s.point_matches),
         pair(s.usable_line_inliers, s.usable_line_matches),
         pair(s.vertical_line_inliers, s.vertical_line_matches),
         FormatNumber(s.typical_point_matches, 1), FormatNumber(s.typical_usable_line_matches, 1),
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

bool HasLabels(const Session& session, const std::vector<std::string>& labels) {
  return std::all_of(labels.begin(), labels.end(), [&](const std::string& label) {
    const std::size_t split = label.find('=');
    const auto found = session.labels.find(label.substr(0, split));
    return found != session.labels.end() && found->second == label.substr(split + 1);
  });
}

std::optional<std::string> ValueOf(const Session& session, const std::string& key) {
  const auto found = session.labels.find(key);
  if (found == session.labels.end()) return std::nullopt;
  return found->second;
}

// The chosen sessions, by the value of the label of --by; without it all under one.
using Selection = std::map<std::optional<std::string>, std::map<SessionId, MapKey>>;

Result<Selection> Select(const MapStore& store, const StatsFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto sessions, store.ListSessions());
  Selection selection;
  if (flags.by.empty()) selection.try_emplace(std::nullopt);
  for (const Session& session : sessions) {
    if (session.map.name != flags.map || !HasLabels(session, flags.labels)) continue;
    const auto value = flags.by.empty() ? std::nullopt : ValueOf(session, flags.by);
    selection[value].emplace(session.id, session.map);
  }
  return selection;
}

// `summary` of the chosen sessions alone.
SegmentStats StatsOf(SegmentSummary summary, std::vector<SegmentSessionRow> rows,
                     const std::map<SessionId, MapKey>& chosen, const MapKey& key) {
  std::erase_if(rows, [&](const SegmentSessionRow& row) { return !chosen.contains(row.session); });
  SegmentStats stats;
  const StatisticsOptions& options = summary.selector.statistics;
  summary.statistics = Aggregate(rows, options);
  stats.summary = std::move(summary);
  stats.changes = FindChanges(rows, options);
  stats.inherited_sessions =
      std::count_if(rows.begin(), rows.end(),
                    [&](const SegmentSessionRow& row) { return chosen.at(row.session) != key; });
  return stats;
}

Result<std::vector<Group>> ReadGroups(const MapStore& store, const MapKey& key,
                                      const StatsFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const Selection selection, Select(store, flags));
  std::vector<Group> groups;
  for (const auto& [value, chosen] : selection) groups.push_back({value, {}});
  MAPLOC_ASSIGN_OR_RETURN(const auto segments, store.ListSegments(key));
  for (const SegmentSummary& segment : segments) {
    if (flags.recompute) {
      MAPLOC_RETURN_IF_ERROR(CheckRecomputed(store, key, segment));
    }
    MAPLOC_ASSIGN_OR_RETURN(const auto rows, store.ListRows(key, segment.id));
    auto group = groups.begin();
    for (const auto& [value, chosen] : selection) {
      (group++)->segments.push_back(StatsOf(segment, rows, chosen, key));
    }
  }
  return groups;
}

void PrintJsonOf(const std::vector<Group>& groups, const StatsFlags& flags) {
  if (flags.by.empty()) return PrintJson(ToJson(groups.front().segments, flags.recompute));
  auto document = nlohmann::ordered_json::array();
  for (const Group& group : groups) {
    document.push_back({{"by", flags.by},
                        {"value", group.value ? nlohmann::ordered_json(*group.value)
                                              : nlohmann::ordered_json(nullptr)},
                        {"segments", ToJson(group.segments, flags.recompute)}});
  }
  PrintJson(document);
}

void PrintText(const std::vector<Group>& groups, const StatsFlags& flags) {
  for (const Group& group : groups) {
    if (!flags.by.empty()) {
      std::cout << (group.value ? flags.by + "=" + *group.value : "without " + flags.by) << "\n";
    }
    PrintTable(group.segments);
    PrintDeclines(DeclinesOf(group.segments));
    std::cout << "\n";
  }
  if (flags.recompute) {
    std::cout << "Recomputed from the sessions' rows: equal to the bit in all segments.\n";
  }
}

Status Stats(const CommandContext& context, const StatsFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, FindMap(*store, flags.map, flags.version));
  MAPLOC_ASSIGN_OR_RETURN(const auto groups, ReadGroups(*store, map.info.key, flags));
  context.json ? PrintJsonOf(groups, flags) : PrintText(groups, flags);
  return Status::Ok();
}

}  // namespace

void AddStatsCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<StatsFlags>();
  CLI::App* command = AddCommand(
      app, context, "stats", "Shows the sums that a map's strategies are chosen from",
      "maploc-map stats --store campus.db --map campus --recompute\n"
      "  maploc-map stats --store campus.db --map campus --label season=autumn --by light",
      [&context, flags] { return Stats(context, *flags); });
  AddMapOption(*command, flags->map);
  AddVersionOption(*command, flags->version);
  command
      ->add_option("--label", flags->labels, "Only sessions with this label (repeatable: with all)")
      ->check(CLI::Validator(
          [](const std::string& label) {
            const std::size_t split = label.find('=');
            const bool good = split != std::string::npos && split > 0;
            return good ? std::string() : "a label is KEY=VALUE, not '" + label + "'";
          },
          "KEY=VALUE", "label"))
      ->allow_extra_args(false);
  command->add_option("--by", flags->by, "One table for each value of this label")
      ->type_name("KEY");
  command->add_flag("--recompute", flags->recompute,
                    "Derive them anew from the sessions' rows and compare to the bit");
}

}  // namespace maploc
