#include "client/robot/load.h"

#include <iostream>
#include <memory>

#include "client/cli/commands.h"
#include "client/cli/output.h"
#include "client/cli/recording_flags.h"
#include "client/cli/stop_signals.h"
#include "client/robot/metrics.h"
#include "mapstore/base/table.h"

namespace maploc {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kExample[] =
    "  maploc load --server 127.0.0.1:50051 --map yard --colmap session_1 --database database.db "
    "\\\n"
    "      --gravity-noise-deg 0.5 --robots 16 --seconds 30 --json";

struct LoadFlags {
  std::string map;
  RecordingOptions recording;
  double seconds = 10.0;
  bool without_sessions = false;
  LoadOptions load;
};

Json LatencyJson(const std::vector<double>& values) {
  return {{"p50", JsonOrNull(Quantile(values, 0.5))},
          {"p95", JsonOrNull(Quantile(values, 0.95))},
          {"p99", JsonOrNull(Quantile(values, 0.99))},
          {"max", JsonOrNull(Quantile(values, 1.0))}};
}

double PerSecond(const LoadReport& report) {
  return static_cast<double>(report.requests) / report.elapsed.count();
}

std::int64_t CalibrationInconsistent(const LoadReport& report) {
  const auto found = report.outcomes.find(Outcome::kCalibrationInconsistent);
  return found == report.outcomes.end() ? 0 : found->second;
}

Json ReportJson(const LoadReport& report) {
  Json outcomes = Json::object();
  for (const auto& [outcome, count] : report.outcomes) {
    outcomes[std::string(OutcomeName(outcome))] = count;
  }
  return {{"requests", report.requests},
          {"per_second", PerSecond(report)},
          {"latency_ms", LatencyJson(report.latencies_ms)},
          {"outcomes", outcomes},
          {"gravity_rejected", report.gravity_rejected},
          {"calibration_inconsistent", CalibrationInconsistent(report)},
          {"errors", report.errors},
          {"sessions", report.end_session_ms.size()},
          {"end_session_ms", LatencyJson(report.end_session_ms)}};
}

void PrintReport(const LoadReport& report) {
  Table table({"", "count", "p50 ms", "p95 ms", "p99 ms", "max ms"});
  const auto add = [&table](const std::string& name, const std::vector<double>& values) {
    table.AddRow({name, std::to_string(values.size()), FormatNumber(Quantile(values, 0.5), 1),
                  FormatNumber(Quantile(values, 0.95), 1), FormatNumber(Quantile(values, 0.99), 1),
                  FormatNumber(Quantile(values, 1.0), 1)});
  };
  add("Localize", report.latencies_ms);
  add("EndSession", report.end_session_ms);
  table.Print(std::cout);
  std::cout << FormatNumber(PerSecond(report), 1) << " requests a second\n";
  for (const auto& [outcome, count] : report.outcomes) {
    std::cout << OutcomeName(outcome) << " " << count << "\n";
  }
  if (report.gravity_rejected > 0) {
    std::cout << "of those, against the gravity that was sent: " << report.gravity_rejected << "\n";
  }
  for (const auto& [code, count] : report.errors) {
    std::cout << Colour(Ink::kRed, code) << " " << count << "\n";
  }
}

// Made beforehand, so that no robot waits for its own features.
Result<std::vector<Query>> MakeQueries(const RecordedRobot& robot) {
  std::vector<Query> queries;
  Progress progress("queries", robot.QueryCount());
  for (int i = 0; i < robot.QueryCount(); ++i) {
    MAPLOC_ASSIGN_OR_RETURN(queries.emplace_back(), robot.MakeQuery(i));
    progress.Advance(robot.QueryName(i));
  }
  if (queries.empty()) return InvalidArgument("colmap", "the model has no posed image");
  return queries;
}

Status Check(const LoadFlags& flags) {
  MAPLOC_RETURN_IF_ERROR(CheckRange("robots", flags.load.robots, 1, 10000));
  MAPLOC_RETURN_IF_ERROR(CheckRange("seconds", flags.seconds, 0, 1e6));
  MAPLOC_RETURN_IF_ERROR(CheckRange("rate", flags.load.rate_per_second, 0, 1e6));
  return CheckRange("session-queries", flags.load.queries_a_session, 1, 1000000);
}

Status Run(const CommandContext& context, const LoadFlags& flags) {
  MAPLOC_RETURN_IF_ERROR(Check(flags));
  MAPLOC_ASSIGN_OR_RETURN(const Client client, Connect(context));
  MAPLOC_ASSIGN_OR_RETURN(const RemoteMap map, client.GetMap(flags.map));
  MAPLOC_ASSIGN_OR_RETURN(const RecordedRobot robot,
                          RecordedRobot::Open(flags.recording, map.info));
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<Query> queries, MakeQueries(robot));
  PrintNotes(robot.Notes());
  LoadOptions options = flags.load;
  MAPLOC_ASSIGN_OR_RETURN(options.client, ClientOptionsFrom(context));
  options.stop = StopRequested;
  // Only from here on sessions are open. Before, Ctrl-C may end the program at once.
  CatchStopSignals();
  options.duration = std::chrono::duration<double>(flags.seconds);
  options.sessions = !flags.without_sessions;
  MAPLOC_ASSIGN_OR_RETURN(const LoadReport report,
                          RunLoad(context.server, flags.map, queries, options));
  context.json ? PrintJson(ReportJson(report)) : PrintReport(report);
  if (!StopRequested()) return Status::Ok();
  return Status(StatusCode::kCancelled, "INTERRUPTED",
                "interrupted; every session was ended, and what is reported was counted");
}

}  // namespace

void AddLoadCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<LoadFlags>();
  CLI::App* command =
      AddCommand(app, context, "load",
                 "Many robots at once, each asking a recording's queries over and over; their "
                 "sessions count in the map's statistics, unless --without-sessions",
                 kExample, [&context, flags] { return Run(context, *flags); });
  AddServerFlag(*command, context)->required();
  command->add_option("--map", flags->map, "the map's name")->required();
  AddRecordingFlags(*command, flags->recording);
  command->add_option("--robots", flags->load.robots, "robots, each with its own connection")
      ->capture_default_str();
  command->add_option("--seconds", flags->seconds, "how long")->capture_default_str();
  command->add_option("--rate", flags->load.rate_per_second,
                      "queries a second of all robots together (default: as fast as answers come)");
  command
      ->add_option("--session-queries", flags->load.queries_a_session,
                   "queries after which a robot ends its session and starts another")
      ->capture_default_str();
  command->add_flag("--without-sessions", flags->without_sessions,
                    "ask outside of any session: nothing is counted");
}

}  // namespace maploc
