#include <iostream>
#include <optional>

#include "mapstore/base/angles.h"
#include "mapstore/base/table.h"
#include "mapstore/base/text.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/fleet.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

struct RobotsFlags {
  std::string map;
  std::optional<std::int64_t> version;  // else the enabled one
};

// Of its queries; nullopt: it has none.
std::optional<double> ShareOf(std::int64_t count, const RobotComparison& robot) {
  if (robot.queries == 0) return std::nullopt;
  return static_cast<double>(count) / static_cast<double>(robot.queries);
}

nlohmann::ordered_json OrNull(const std::string& remark) {
  return remark.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(remark);
}

nlohmann::ordered_json ToJson(const RobotComparison& robot) {
  return {
      {"robot", robot.robot},
      {"sessions", robot.sessions},
      {"queries", robot.queries},
      {"localized", robot.localized},
      {"stands_out", robot.StandsOut()},
      {"differences", ToJson(robot.differences)},
      {"calibration_inconsistent", robot.calibration_inconsistent},
      {"calibration_inconsistent_share", JsonRatio(ShareOf(robot.calibration_inconsistent, robot))},
      {"calibration_remark", OrNull(DescribeCalibration(robot))},
      {"gravity_rejected", robot.gravity_rejected},
      {"gravity_rejected_share", JsonRatio(ShareOf(robot.gravity_rejected, robot))},
      {"gravity_remark", OrNull(DescribeGravity(robot))}};
}

// "own / others", or "-" where there is nothing to compare.
std::string Pair(const RobotComparison& robot, RobotMetric metric, double unit) {
  for (const RobotDifference& difference : robot.differences) {
    if (difference.metric != metric) continue;
    return FixedText(unit * difference.own, 2) + " / " + FixedText(unit * difference.others, 2);
  }
  return "-";
}

std::string CountCell(std::int64_t count, const RobotComparison& robot) {
  return std::to_string(count) + " (" + FormatRatio(ShareOf(count, robot)) + ")";
}

void PrintTable(const FleetComparison& fleet) {
  Table table({"robot", "sessions", "queries", "localized", "gravity, degrees", "points", "lines",
               "success", "calibration off", "gravity off", "stands out"});
  for (const RobotComparison& robot : fleet.robots) {
    table.AddRow({robot.robot, std::to_string(robot.sessions), std::to_string(robot.queries),
                  std::to_string(robot.localized), Pair(robot, RobotMetric::kGravity, kDegPerRad),
                  Pair(robot, RobotMetric::kPoints, 1.0), Pair(robot, RobotMetric::kLines, 1.0),
                  Pair(robot, RobotMetric::kSuccess, 1.0),
                  CountCell(robot.calibration_inconsistent, robot),
                  CountCell(robot.gravity_rejected, robot), DescribeFlags(robot.differences)});
  }
  table.Print(std::cout);
  std::cout << "Each pair: the robot's, and that of the other robots in the same segments at about "
               "the same "
               "time.\n";
  for (const RobotComparison& robot : fleet.robots) {
    for (const std::string& remark : {DescribeCalibration(robot), DescribeGravity(robot)}) {
      if (!remark.empty()) std::cout << robot.robot << ": " << remark << ".\n";
    }
  }
  if (fleet.robots.size() < 2) std::cout << "It takes two robots to compare.\n";
}

Status Robots(const CommandContext& context, const RobotsFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, FindMap(*store, flags.map, flags.version));
  MAPLOC_ASSIGN_OR_RETURN(const auto sessions, ReadSessions(*store, map.info.key));
  const FleetComparison fleet = CompareFleet(sessions, map.info.key);
  if (!context.json) return PrintTable(fleet), Status::Ok();
  auto document = nlohmann::ordered_json::array();
  for (const RobotComparison& robot : fleet.robots) document.push_back(ToJson(robot));
  PrintJson(document);
  return Status::Ok();
}

}  // namespace

void AddRobotsCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<RobotsFlags>();
  CLI::App* command = AddCommand(app, context, "robots",
                                 "Compares each robot with the others in the same segments; says "
                                 "whose calibration or gravity is off",
                                 "maploc-map robots --store campus.db --map campus",
                                 [&context, flags] { return Robots(context, *flags); });
  AddMapOption(*command, flags->map);
  AddVersionOption(*command, flags->version);
}

}  // namespace maploc
