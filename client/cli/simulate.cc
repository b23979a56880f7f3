#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include <unistd.h>

#include "client/cli/campus_picture.h"
#include "client/cli/commands.h"
#include "client/cli/output.h"
#include "client/cli/replay_report.h"
#include "client/cli/season_board.h"
#include "client/cli/stop_signals.h"
#include "client/robot/simulated_map.h"
#include "client/robot/simulated_robot.h"
#include "mapstore/base/table.h"

namespace maploc {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kExample[] =
    "  maploc simulate --write-world campus\n"
    "  maploc-map import-colmap --store maps.db --map campus --model campus/model \\\n"
    "      --database campus/database.db --descriptors orb --lines campus/lines.txt \\\n"
    "      --gravity 0,0,-1 --scale 1 --segment-length 45\n"
    "  maploc simulate --server 127.0.0.1:50051 --map campus --picture campus.svg";

// Where the camera, turned to the right, mostly looks: this far ahead along the lane.
constexpr double kLookAheadM = 8.0;

struct SimulateFlags {
  std::string write_world;
  std::string map;
  std::string picture;
  std::vector<std::string> seasons = {"summer", "autumn", "winter", "spring"};
  int robots = 3;
  int queries = 45;
  std::uint64_t seed = 1;
};

struct SeasonResult {
  Season season;
  std::vector<ReplayReport> sessions;  // one a robot
};

std::string RobotName(int robot) {
  constexpr const char* kNames[] = {"robin", "wren", "finch", "siskin", "linnet", "martin"};
  constexpr int kCount = 6;
  const std::string round = robot < kCount ? "" : "-" + std::to_string(robot / kCount + 1);
  return kNames[robot % kCount] + round;
}

Status WriteWorld(const World& world, const SimulateFlags& flags, bool json) {
  MAPLOC_ASSIGN_OR_RETURN(const MappingSummary summary,
                          WriteMappingDrive(world, {}, flags.write_world));
  if (json) {
    PrintJson(
        {{"key_frames", summary.key_frames}, {"points", summary.points}, {"lines", summary.lines}});
    return Status::Ok();
  }
  std::cout << "mapping drive in summer: " << summary.key_frames << " key frames, "
            << summary.points << " points and " << summary.lines << " lines in "
            << flags.write_world << "\n";
  return Status::Ok();
}

// All robots drive through one season at once, each in its own thread with its own connection.
class SeasonRun {
 public:
  SeasonRun(const CommandContext& context, const SimulateFlags& flags, const World& world,
            const RemoteMap& map, Season season)
      : context_(context), flags_(flags), world_(world), map_(map), season_(season) {}

  Result<SeasonResult> Run() {
    // With --json standard output is the document's; people watch standard error.
    const bool live = !context_.json && isatty(STDOUT_FILENO) != 0;
    std::vector<std::string> names;
    for (int i = 0; i < flags_.robots; ++i) names.push_back(RobotName(i));
    SeasonBoard board(context_.json ? std::cerr : std::cout, live, names, flags_.queries);

    std::vector<Result<ReplayReport>> reports(flags_.robots,
                                              Status(Internal("a robot has not started")));
    std::vector<std::jthread> threads;
    for (int i = 0; i < flags_.robots; ++i) {
      threads.emplace_back([&, i] { reports[i] = Drive(i, board); });
    }
    // Joins them: no report is read before its robot has finished.
    threads.clear();

    MAPLOC_RETURN_IF_ERROR(AllFailures(reports));
    SeasonResult result{season_, {}};
    for (Result<ReplayReport>& report : reports) result.sessions.push_back(*std::move(report));
    return result;
  }

 private:
  // The first, with the messages of all: each names a session.
  static Status AllFailures(const std::vector<Result<ReplayReport>>& reports) {
    Status first;
    std::string messages;
    for (const Result<ReplayReport>& report : reports) {
      if (report.ok()) continue;
      if (first.ok()) first = report.status();
      messages += (messages.empty() ? "" : " | ") + report.status().message();
    }
    return first.ok() ? first : Status(first.code(), first.reason(), messages);
  }

  Result<ReplayReport> Drive(int robot, SeasonBoard& board) const {
    DriveOptions drive;
    drive.queries = flags_.queries;
    drive.season = season_;
    drive.aside_m = 1.6 * (robot % 3 - 1);
    drive.start_m = robot * world_.LaneLength() / flags_.queries / flags_.robots;
    // A robot drives alike in every run, and another way in every season.
    drive.seed = HashBytes(RobotName(robot) + std::string(SeasonName(season_)), flags_.seed);
    ReplayOptions options;
    options.robot = RobotName(robot);
    options.labels = {{"season", std::string(SeasonName(season_))}};
    options.stop = StopRequested;
    MAPLOC_ASSIGN_OR_RETURN(const Client client, Connect(context_));
    return Replay(client, flags_.map, SimulatedRobot(world_, drive, map_.info), options,
                  [&](const ReplayEntry& entry) { board.Add(robot, entry); });
  }

  const CommandContext& context_;
  const SimulateFlags& flags_;
  const World& world_;
  const RemoteMap& map_;
  const Season season_;
};

void PrintStrategyChanges(const std::vector<RemoteSegment>& before,
                          const std::vector<RemoteSegment>& after, std::ostream& out) {
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
    const Strategy was = before[i].decision.strategy;
    const Strategy is = after[i].decision.strategy;
    if (was == is) continue;
    out << "  learned: segment " << after[i].id << " now draws "
        << Colour(Ink::kBold, std::string(StrategyName(is))) << " (was " << StrategyName(was)
        << ")\n";
  }
}

// What stands around a segment's middle.
std::string Surroundings(const World& world, const MapInfo& map, const RemoteSegment& segment) {
  if (segment.path_in_map.empty()) return "";
  const Eigen::Vector3d middle =
      map.map_from_source.Inverse() * segment.path_in_map[segment.path_in_map.size() / 2];
  const double along_m = std::atan2(middle.y(), middle.x()) * world.radius_m + kLookAheadM;
  return world.IsStructured(world.StretchAt(along_m)) ? "houses" : "trees";
}

struct Outcomes {
  std::vector<RemoteSegment> before;
  std::vector<RemoteSegment> after;  // with their paths
  std::vector<SeasonResult> seasons;
};

// None where another version of the map, with other segments, was enabled during the run.
std::optional<Strategy> StrategyBefore(const Outcomes& outcomes, const RemoteSegment& segment) {
  const auto before = std::ranges::find(outcomes.before, segment.id, &RemoteSegment::id);
  if (before == outcomes.before.end()) return std::nullopt;
  return before->decision.strategy;
}

void PrintSegments(const World& world, const MapInfo& map, const Outcomes& outcomes,
                   std::ostream& out) {
  Table table({"segment", "around", "points", "lines (usable)", "point inliers", "line inliers",
               "strategy before", "after", "localized"});
  for (const RemoteSegment& segment : outcomes.after) {
    const std::optional<Strategy> before = StrategyBefore(outcomes, segment);
    table.AddRow({std::to_string(segment.id), Surroundings(world, map, segment),
                  std::to_string(segment.points),
                  std::to_string(segment.lines) + " (" + std::to_string(segment.usable_lines) + ")",
                  FormatNumber(segment.point_inlier_ratio, 2),
                  FormatNumber(segment.line_inlier_ratio, 2),
                  before ? std::string(StrategyName(*before)) : "-",
                  Colour(Ink::kBold, std::string(StrategyName(segment.decision.strategy))),
                  std::to_string(segment.localized) + "/" + std::to_string(segment.queries)});
  }
  table.Print(out);
}

Metrics SeasonMetrics(const SeasonResult& result) {
  std::vector<std::optional<PoseError>> errors;
  for (const ReplayReport& session : result.sessions) {
    const auto own = session.Errors();
    errors.insert(errors.end(), own.begin(), own.end());
  }
  return Summarize(errors);
}

void PrintSeasons(const Outcomes& outcomes, std::ostream& out) {
  Table table({"season", "localized", "wrong", "median error", "within 0.25 m, 2 deg", "auc"});
  for (const SeasonResult& result : outcomes.seasons) {
    const Metrics metrics = SeasonMetrics(result);
    table.AddRow({std::string(SeasonName(result.season)),
                  std::to_string(metrics.localized) + "/" + std::to_string(metrics.queries),
                  std::to_string(metrics.wrong),
                  FormatNumber(metrics.median_translation_error_m, 3) + " m, " +
                      FormatNumber(metrics.median_rotation_error_deg, 2) + " deg",
                  FormatNumber(100.0 * metrics.recall[0], 1) + "%", FormatNumber(metrics.auc, 3)});
  }
  table.Print(out);
}

Json OutcomesJson(const World& world, const RemoteMap& map, const Outcomes& outcomes) {
  Json sessions = Json::array();
  for (const SeasonResult& result : outcomes.seasons) {
    for (std::size_t i = 0; i < result.sessions.size(); ++i) {
      Json session = ReplayJson(map, result.sessions[i]);
      session["robot"] = RobotName(static_cast<int>(i));
      session["season"] = SeasonName(result.season);
      sessions.push_back(std::move(session));
    }
  }
  Json segments = Json::array();
  for (const RemoteSegment& segment : outcomes.after) {
    const std::optional<Strategy> before = StrategyBefore(outcomes, segment);
    segments.push_back({{"segment", segment.id},
                        {"around", Surroundings(world, map.info, segment)},
                        {"point_inlier_ratio", JsonOrNull(segment.point_inlier_ratio)},
                        {"line_inlier_ratio", JsonOrNull(segment.line_inlier_ratio)},
                        {"strategy_before", before ? Json(StrategyName(*before)) : Json()},
                        {"strategy_after", StrategyName(segment.decision.strategy)},
                        {"queries", segment.queries},
                        {"localized", segment.localized}});
  }
  return {{"sessions", std::move(sessions)}, {"segments", std::move(segments)}};
}

Result<std::vector<RemoteSegment>> SegmentsWithPaths(const Client& client, const std::string& map) {
  MAPLOC_ASSIGN_OR_RETURN(std::vector<RemoteSegment> segments, client.ListSegments(map));
  for (RemoteSegment& segment : segments) {
    MAPLOC_ASSIGN_OR_RETURN(segment, client.GetSegment(map, segment.id));
  }
  return segments;
}

Result<Outcomes> DriveAllSeasons(const CommandContext& context, const SimulateFlags& flags,
                                 const World& world, const RemoteMap& map, std::ostream& out) {
  MAPLOC_ASSIGN_OR_RETURN(const Client client, Connect(context));
  Outcomes outcomes;
  MAPLOC_ASSIGN_OR_RETURN(outcomes.before, client.ListSegments(flags.map));
  std::vector<RemoteSegment> last = outcomes.before;
  for (const std::string& name : flags.seasons) {
    out << "\n" << Colour(Ink::kBold, name) << "\n";
    MAPLOC_ASSIGN_OR_RETURN(SeasonResult result,
                            SeasonRun(context, flags, world, map, *SeasonFromName(name)).Run());
    MAPLOC_ASSIGN_OR_RETURN(outcomes.after, SegmentsWithPaths(client, flags.map));
    PrintStrategyChanges(last, outcomes.after, out);
    last = outcomes.after;
    outcomes.seasons.push_back(std::move(result));
  }
  return outcomes;
}

Status DriveAndReport(const CommandContext& context, const SimulateFlags& flags,
                      const World& world) {
  if (context.server.empty() || flags.map.empty()) {
    return InvalidArgument("simulate", "needs --server and --map, or --write-world");
  }
  MAPLOC_ASSIGN_OR_RETURN(const Client client, Connect(context));
  MAPLOC_ASSIGN_OR_RETURN(const RemoteMap map, client.GetMap(flags.map));
  CatchStopSignals();
  std::ostream& people = context.json ? std::cerr : std::cout;
  people << "one mark a query: " << Colour(Ink::kGreen, "|") << " within 0.25 m and 2 degrees, "
         << Colour(Ink::kYellow, ":") << " coarser, " << Colour(Ink::kGrey, "o")
         << " not localized, " << Colour(Ink::kRed, "X") << " wrong\n"
         << "then: localized, median errors, median time of a call\n";
  MAPLOC_ASSIGN_OR_RETURN(const Outcomes outcomes,
                          DriveAllSeasons(context, flags, world, map, people));
  if (!flags.picture.empty()) {
    std::vector<ReplayReport> sessions;
    for (const SeasonResult& result : outcomes.seasons) {
      sessions.insert(sessions.end(), result.sessions.begin(), result.sessions.end());
    }
    MAPLOC_RETURN_IF_ERROR(
        WriteCampusPicture(flags.picture, world, map.info, outcomes.after, sessions));
  }
  if (context.json) {
    PrintJson(OutcomesJson(world, map, outcomes));
    return Status::Ok();
  }
  std::cout << "\n";
  PrintSeasons(outcomes, std::cout);
  std::cout << "\n";
  PrintSegments(world, map.info, outcomes, std::cout);
  return Status::Ok();
}

Status Run(const CommandContext& context, const SimulateFlags& flags) {
  MAPLOC_RETURN_IF_ERROR(CheckRange("robots", flags.robots, 1, 64));
  MAPLOC_RETURN_IF_ERROR(CheckRange("queries", flags.queries, 1, 10000));
  CampusOptions campus;
  campus.seed = flags.seed;
  const World world = MakeCampus(campus);
  if (!flags.write_world.empty()) return WriteWorld(world, flags, context.json);
  return DriveAndReport(context, flags, world);
}

}  // namespace

void AddSimulateCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<SimulateFlags>();
  CLI::App* command = AddCommand(app, context, "simulate",
                                 "Robots in a made-up campus whose appearance changes with the "
                                 "season; or write that campus as a "
                                 "model to import",
                                 kExample, [&context, flags] { return Run(context, *flags); });
  CLI::Option* write = command->add_option("--write-world", flags->write_world,
                                           "write the campus's mapping drive into this folder");
  // Flags of the drive say nothing to --write-world, and are refused instead of ignored.
  AddServerFlag(*command, context)->excludes(write);
  command->add_option("--map", flags->map, "the campus's map")->excludes(write);
  command->add_option("--picture", flags->picture, "write the campus, seen from above, as SVG")
      ->excludes(write);
  command->add_option("--seasons", flags->seasons, "in their order, one session a robot in each")
      ->delimiter(',')
      ->excludes(write)
      ->check(CLI::IsMember({"summer", "autumn", "winter", "spring"}))
      ->capture_default_str();
  command->add_option("--robots", flags->robots, "how many drive at once")
      ->excludes(write)
      ->capture_default_str();
  command->add_option("--queries", flags->queries, "of a session: once around the campus")
      ->excludes(write)
      ->capture_default_str();
  command->add_option("--seed", flags->seed, "of the campus and of the robots")
      ->capture_default_str();
}

}  // namespace maploc
