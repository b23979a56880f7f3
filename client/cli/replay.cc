#include <iostream>
#include <memory>
#include <sstream>

#include "client/cli/commands.h"
#include "client/cli/output.h"
#include "client/cli/recording_flags.h"
#include "client/cli/replay_recorded.h"
#include "client/cli/replay_report.h"
#include "client/cli/stop_signals.h"
#include "mapstore/base/standard_output.h"

namespace maploc {
namespace {

constexpr char kExample[] =
    "  maploc replay --server 127.0.0.1:50051 --map yard --colmap session_1 --database database.db "
    "\\\n"
    "      --gravity-csv gravity.csv --label season=autumn\n"
    "  maploc replay --server 127.0.0.1:50051 --map church --colmap query --images photos \\\n"
    "      --gravity-noise-deg 0.5 --json\n"
    "  maploc replay --server 127.0.0.1:50051 --recorded recording --map yard --outcome "
    "LOW_CONFIDENCE";

struct ReplayFlags {
  std::string map;
  RecordingOptions recording;
  MethodFlags method;
  std::string prior = "none";
  std::string robot = "maploc-replay";
  std::vector<std::string> labels;
  bool keep_partial = false;
  RecordedFlags recorded;
};

// What a recorded query brings itself, or what a session needs.
constexpr const char* kNotRecorded[] = {"--colmap",
                                        "--database",
                                        "--images",
                                        "--gravity-csv",
                                        "--gravity-noise-deg",
                                        "--gravity-sigma-deg",
                                        "--without-gravity",
                                        "--max-features",
                                        "--seed",
                                        "--strategy",
                                        "--refine",
                                        "--max-error",
                                        "--prior",
                                        "--label",
                                        "--keep-partial"};

ReplayOptions OptionsFrom(const ReplayFlags& flags) {
  ReplayOptions options;
  options.robot = flags.robot;
  options.labels = ParseLabels(flags.labels);
  options.strategy = flags.method.RequestedStrategy();
  options.refinement = flags.method.RequestedRefinement();
  options.max_error_px = flags.method.max_error_px;
  options.prior = flags.prior == "previous" ? PriorMode::kPrevious : PriorMode::kNone;
  options.stop = StopRequested;
  options.keep_partial = flags.keep_partial;
  return options;
}

std::string LateText(const ReplayReport& report, double timeout_s) {
  std::ostringstream text;
  text << report.CountLate() << " of " << report.entries.size() << " queries had no answer within "
       << timeout_s << " s and count as not localized; --timeout SECONDS waits longer";
  return text.str();
}

Status Run(const CommandContext& context, const ReplayFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const Client client, Connect(context));
  MAPLOC_ASSIGN_OR_RETURN(const RemoteMap map, client.GetMap(flags.map));
  MAPLOC_ASSIGN_OR_RETURN(const RecordedRobot robot,
                          RecordedRobot::Open(flags.recording, map.info));
  PrintNotes(robot.Notes());
  // Only from here on a session is open. Before, Ctrl-C may end the program at once.
  CatchStopSignals();
  Result<ReplayReport> report = [&] {
    Progress progress("replay", robot.QueryCount());
    return Replay(client, flags.map, robot, OptionsFrom(flags), [&](const ReplayEntry& entry) {
      progress.Advance(entry.name + " " + std::string(entry.OutcomeName()));
    });
  }();
  if (!report.ok()) return report.status();
  context.json ? PrintJson(ReplayJson(map, *report)) : PrintReplay(map, *report, std::cout);
  if (!JudgesWrong(map, *report)) {
    PrintNotes(
        {"wrong answers cannot be judged: the map has no unit (import it with --scale), and "
         "no image of the query model observes points"});
  }
  if (report->CountLate() > 0) {
    PrintNotes({LateText(*report, context.timeout_s)});
  }
  if (!report->failure.ok()) return report->failure;
  // The id stands in the output alone.
  return FlushStandardOutput().WithContext("session " + report->session + " was counted, but");
}

}  // namespace

void AddReplayCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<ReplayFlags>();
  CLI::App* command = AddCommand(
      app, context, "replay",
      "A recorded session: one query a posed image, compared with its reference pose; --json "
      "reports each error beside its sigma",
      kExample, [&context, flags] {
        return flags->recorded.path.empty() ? Run(context, *flags)
                                            : ReplayRecorded(context, flags->recorded);
      });
  AddServerFlag(*command, context)->required();
  CLI::Option* const map = command->add_option(
      "--map", flags->map, "the map's name; with --recorded: queries on this map alone");
  AddRecordingFlags(*command, flags->recording);
  AddMethodFlags(*command, flags->method);
  command->add_option("--prior", flags->prior, "send the last localized position as a hint")
      ->check(CLI::IsMember({"none", "previous"}))
      ->capture_default_str();
  CLI::Option* const robot =
      command
          ->add_option("--robot", flags->robot,
                       "the robot's name; with --recorded: queries of this robot alone")
          ->capture_default_str();
  command->add_option("--label", flags->labels, "KEY=VALUE, kept with the session; repeatable")
      ->check(LabelCheck());
  command->add_flag(
      "--keep-partial", flags->keep_partial,
      "of a session that fails or is interrupted, report what was answered, and count "
      "it in the statistics; else it is neither reported nor counted (the exit code "
      "is 1 both ways)");
  CLI::Option* const recorded = AddRecordedFlags(*command, flags->recorded);
  for (const char* const flag : kNotRecorded) recorded->excludes(flag);
  CLI::Option* const model = command->get_option("--colmap")->required(false);
  command->parse_complete_callback([flags, map, robot, model, recorded] {
    if (recorded->count() == 0) {
      if (map->count() == 0) throw CLI::RequiredError("--map");
      if (model->count() == 0) throw CLI::RequiredError("--colmap or --recorded");
    }
    flags->recorded.filter.map = flags->map;
    if (robot->count() > 0) flags->recorded.filter.robot = flags->robot;
  });
}

}  // namespace maploc
