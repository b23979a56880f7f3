#include <iostream>
#include <map>

#include "mapstore/base/table.h"
#include "mapstore/base/text.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/fleet.h"
#include "mapstore/tools/lean_warning.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct SessionLine {
  Session session;
  std::int64_t queries = 0;
  std::int64_t localized = 0;
  std::map<SegmentId, std::int64_t> visits;  // queries by segment
  std::vector<RobotDifference> differences;  // from the other robots; empty if revoked
};

std::string EndName(SessionEnd end) {
  switch (end) {
    case SessionEnd::kOpen:
      return "open";
    case SessionEnd::kByRobot:
      return "by_robot";
    case SessionEnd::kIdle:
      return "idle";
  }
  return "unknown";
}

nlohmann::ordered_json VisitsToJson(const SessionLine& line) {
  auto visits = nlohmann::ordered_json::array();
  for (const auto& [segment, queries] : line.visits) {
    visits.push_back({{"segment", segment}, {"queries", queries}});
  }
  return visits;
}

nlohmann::ordered_json ToJson(const SessionLine& line) {
  const Session& session = line.session;
  return {{"session", session.id},
          {"map", session.map.name},
          {"version", session.map.version},
          {"robot", session.robot},
          {"labels", session.labels},
          {"start_unix_ns", session.start_unix_ns},
          {"end_unix_ns", session.end == SessionEnd::kOpen
                              ? nlohmann::ordered_json(nullptr)
                              : nlohmann::ordered_json(session.end_unix_ns)},
          {"state", EndName(session.end)},
          {"revoked", session.revoked},
          {"queries", line.queries},
          {"localized", line.localized},
          {"segments", VisitsToJson(line)},
          {"stands_out", !DescribeFlags(line.differences).empty()},
          {"differences", ToJson(line.differences)}};
}

void PrintTable(const std::vector<SessionLine>& lines) {
  Table table({"session", "map", "version", "robot", "labels", "start", "state", "queries",
               "localized", "segments", "stands out"});
  for (const SessionLine& line : lines) {
    const Session& session = line.session;
    std::string labels;
    for (const auto& [name, value] : session.labels) {
      if (name.starts_with("maploc.")) continue;  // the server's own; --json has them
      labels += (labels.empty() ? "" : ", ") + name + "=" + value;
    }
    table.AddRow({session.id, session.map.name, std::to_string(session.map.version), session.robot,
                  labels, UtcText(session.start_unix_ns),
                  EndName(session.end) + (session.revoked ? ", revoked" : ""),
                  std::to_string(line.queries), std::to_string(line.localized),
                  std::to_string(line.visits.size()), DescribeFlags(line.differences)});
  }
  table.Print(std::cout);
}

SessionLine LineOf(const SeenSession& seen) {
  SessionLine line{seen.session, static_cast<std::int64_t>(seen.observations.size()), 0, {}, {}};
  for (const Observation& observation : seen.observations) {
    if (observation.outcome == Outcome::kLocalized) ++line.localized;
    if (observation.segment >= 0) ++line.visits[observation.segment];
  }
  return line;
}

std::vector<SessionLine> MakeLines(const std::vector<SeenSession>& sessions) {
  std::map<MapKey, std::map<SessionId, std::vector<RobotDifference>>> compared;
  for (const SeenSession& seen : sessions) {
    const auto [found, fresh] = compared.try_emplace(seen.session.map);
    // One comparison for each version of a map, not one for each session.
    if (!fresh) continue;
    for (SessionComparison& session : CompareFleet(sessions, found->first).sessions) {
      found->second[session.session] = std::move(session.differences);
    }
  }
  std::vector<SessionLine> lines;
  for (const SeenSession& seen : sessions) {
    lines.push_back(LineOf(seen));
    // A revoked session was not compared, and has none.
    lines.back().differences = std::move(compared[seen.session.map][seen.session.id]);
  }
  return lines;
}

Status Sessions(const CommandContext& context) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const auto sessions, ReadSessions(*store));
  for (const std::string& lean : DescribeLeans(sessions)) std::cerr << lean << "\n";
  const std::vector<SessionLine> lines = MakeLines(sessions);
  if (!context.json) return PrintTable(lines), Status::Ok();
  auto document = nlohmann::ordered_json::array();
  for (const SessionLine& line : lines) document.push_back(ToJson(line));
  PrintJson(document);
  return Status::Ok();
}

}  // namespace

void AddSessionsCommand(CLI::App& app, CommandContext& context) {
  AddCommand(app, context, "sessions",
             "Lists the robots' sessions, oldest first; warns if all robots' gravity differs "
             "from a map's in the same direction",
             "maploc-map sessions --store campus.db", [&context] { return Sessions(context); });
}

}  // namespace maploc
