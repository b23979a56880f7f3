#include "client/cli/replay_report.h"

#include <ostream>

#include "client/cli/output.h"
#include "mapstore/base/angles.h"
#include "mapstore/base/table.h"

namespace maploc {
namespace {

using Json = nlohmann::ordered_json;

struct LineCounts {
  int matches;
  int inliers;
};

LineCounts AllLines(const Evidence& evidence) {
  return {evidence.usable_lines.matches + evidence.vertical_lines.matches,
          evidence.usable_lines.inliers + evidence.vertical_lines.inliers};
}

// The keys are a contract with scripts (README.md): they may be added to, and none renamed.
Json EntryJson(const ReplayEntry& entry) {
  const Localization& answer = entry.localization;
  const LineCounts lines = AllLines(answer.evidence);
  Json json;
  json["name"] = entry.name;
  json["outcome"] = entry.OutcomeName();
  json["translation_error_m"] = entry.error ? Json(entry.error->translation_m) : Json();
  json["rotation_error_deg"] = entry.error ? Json(entry.error->rotation_deg) : Json();
  json["segment"] = answer.segment;
  json["strategy"] = StrategyName(answer.evidence.strategy);
  json["iterations"] = answer.evidence.iterations;
  json["point_matches"] = answer.evidence.points.matches;
  json["point_inliers"] = answer.evidence.points.inliers;
  json["line_matches"] = lines.matches;
  json["line_inliers"] = lines.inliers;
  json["confidence"] = answer.evidence.confidence;
  const std::optional<PoseError> sigma =
      answer.map_from_body ? std::optional(ExpectedError(answer.covariance)) : std::nullopt;
  json["position_sigma_m"] = sigma ? Json(sigma->translation_m) : Json();
  json["rotation_sigma_deg"] = sigma ? Json(sigma->rotation_deg) : Json();
  json["server_ms"] = answer.times.total_ms;
  json["latency_ms"] = entry.latency_ms;
  json["strategy_source"] = StrategySourceName(answer.strategy_source);
  json["fell_back"] = answer.evidence.fell_back;
  json["gravity_disagreement_deg"] = answer.evidence.gravity_disagreement_rad * kDegPerRad;
  json["gravity_rejected"] = answer.evidence.gravity_rejected;
  json["inlier_rms_px"] = answer.evidence.inlier_rms_px;
  json["scene_depth"] = JsonOrNull(entry.scene_depth);
  return json;
}

// Mean share of the server's time that each stage takes.
Json StageShares(const ReplayReport& report) {
  StageTimes sum;
  for (const ReplayEntry& entry : report.entries) {
    const StageTimes& times = entry.localization.times;
    sum.convert_ms += times.convert_ms;
    sum.retrieval_ms += times.retrieval_ms;
    sum.matching_ms += times.matching_ms;
    sum.ransac_ms += times.ransac_ms;
    sum.refinement_ms += times.refinement_ms;
    sum.total_ms += times.total_ms;
  }
  if (sum.total_ms <= 0.0) return Json();
  return {{"convert", sum.convert_ms / sum.total_ms},
          {"retrieval", sum.retrieval_ms / sum.total_ms},
          {"matching", sum.matching_ms / sum.total_ms},
          {"ransac", sum.ransac_ms / sum.total_ms},
          {"refinement", sum.refinement_ms / sum.total_ms}};
}

// Without a unit of length an error says something as a share of the scene's depth alone.
bool TellsDepthShares(const RemoteMap& map, const ReplayReport& report) {
  return !map.info.metric && report.WithinDepthShare().has_value();
}

std::string OutcomeCell(const ReplayEntry& entry) {
  return std::string(entry.OutcomeName()) +
         (entry.localization.evidence.gravity_rejected ? ", not its gravity" : "");
}

std::vector<std::string> EntryCells(const ReplayEntry& entry, bool depth_shares) {
  const Localization& answer = entry.localization;
  const LineCounts lines = AllLines(answer.evidence);
  // Of a late query there is no answer: what stands in `localization` are defaults.
  const bool localized = entry.failure.ok() && answer.outcome == Outcome::kLocalized;
  std::optional<double> length;
  std::optional<double> rotation_deg;
  if (entry.error) {
    length = entry.error->translation_m;
    if (depth_shares && entry.DepthShare()) length = 100.0 * *entry.DepthShare();
    rotation_deg = entry.error->rotation_deg;
  }
  return {entry.name,
          Colour(localized ? Ink::kGreen : Ink::kYellow, OutcomeCell(entry)),
          FormatNumber(length, 3),
          FormatNumber(rotation_deg, 2),
          std::to_string(answer.segment),
          std::string(StrategyName(answer.evidence.strategy)),
          std::to_string(answer.evidence.iterations),
          std::to_string(answer.evidence.points.inliers) + "/" +
              std::to_string(answer.evidence.points.matches),
          std::to_string(lines.inliers) + "/" + std::to_string(lines.matches),
          FormatNumber(localized ? std::optional(answer.evidence.inlier_rms_px) : std::nullopt, 2),
          FormatNumber(answer.evidence.confidence, 3),
          FormatNumber(answer.times.total_ms, 1)};
}

void PrintEntries(const RemoteMap& map, const ReplayReport& report, std::ostream& out) {
  const bool depth_shares = TellsDepthShares(map, report);
  const char* unit = map.info.metric ? "m" : depth_shares ? "% of depth" : "map units";
  Table table({"query", "outcome", std::string("error ") + unit, "deg", "segment", "strategy",
               "iterations", "points", "lines", "rms px", "confidence", "server ms"});
  for (const ReplayEntry& entry : report.entries) table.AddRow(EntryCells(entry, depth_shares));
  table.Print(out);
}

// Nothing where the robot's inputs were believed.
void PrintInputFaults(const InputFaults& faults, std::ostream& out) {
  if (faults.gravity_rejected > 0) {
    out << faults.gravity_rejected << " localized against the gravity that was sent\n";
  }
  if (faults.calibration_inconsistent > 0) {
    out << faults.calibration_inconsistent
        << " not localized: the matches contradict the camera's calibration\n";
  }
}

}  // namespace

bool JudgesWrong(const RemoteMap& map, const ReplayReport& report) {
  return map.info.metric || TellsDepthShares(map, report);
}

Json SummaryJson(const SessionSummary& summary) {
  Json segments = Json::array();
  for (const SessionSummary::SegmentChange& change : summary.segments) {
    segments.push_back({{"segment", change.segment},
                        {"queries", change.queries},
                        {"localized", change.localized},
                        {"strategy_before", StrategyName(change.strategy_before)},
                        {"strategy_after", StrategyName(change.strategy_after)}});
  }
  return {{"session", summary.session},
          {"ended", summary.end == SessionEnd::kIdle ? "idle" : "by_robot"},
          {"queries", summary.queries},
          {"localized", summary.localized},
          {"segments", std::move(segments)}};
}

void PrintSummary(const SessionSummary& summary, std::ostream& out) {
  Table table({"segment", "queries", "localized", "strategy before", "after"});
  for (const SessionSummary::SegmentChange& change : summary.segments) {
    table.AddRow({std::to_string(change.segment), std::to_string(change.queries),
                  std::to_string(change.localized),
                  std::string(StrategyName(change.strategy_before)),
                  std::string(StrategyName(change.strategy_after))});
  }
  out << "session " << summary.session << ": " << summary.localized << " of " << summary.queries
      << " queries localized"
      << (summary.end == SessionEnd::kIdle ? " (closed by the server when idle)" : "") << "\n";
  table.Print(out);
}

Json ReplayJson(const RemoteMap& map, const ReplayReport& report) {
  const Metrics metrics = Summarize(report.Errors());
  const std::vector<double> latencies_ms = report.LatenciesMs();
  Json json;
  json["session"] = report.session;
  json["queries"] = metrics.queries;
  json["localized"] = metrics.localized;
  json["wrong"] = metrics.wrong;
  json["median_translation_error_m"] = JsonOrNull(metrics.median_translation_error_m);
  json["median_rotation_error_deg"] = JsonOrNull(metrics.median_rotation_error_deg);
  for (std::size_t i = 0; i < kRecallThresholds.size(); ++i) {
    json["recall"][std::string(kRecallThresholds[i].name)] = metrics.recall[i];
  }
  json["auc"] = metrics.auc;
  json["latency_ms"] = {{"p50", JsonOrNull(Quantile(latencies_ms, 0.5))},
                        {"p99", JsonOrNull(Quantile(latencies_ms, 0.99))}};
  const InputFaults faults = report.CountInputFaults();
  json["gravity_rejected"] = faults.gravity_rejected;
  json["calibration_inconsistent"] = faults.calibration_inconsistent;
  json["deadline_exceeded"] = report.CountLate();
  json["complete"] = report.failure.ok();
  json["metric"] = map.info.metric;  // false: every "_m" is in the map's unknown unit
  json["median_translation_error_depth_share"] = JsonOrNull(report.MedianDepthShare());
  const std::optional<int> within = report.WithinDepthShare();
  json["within_1pct_depth_1deg"] = within ? Json(*within) : Json();
  json["server_stage_shares"] = StageShares(report);
  json["segments"] = SummaryJson(report.summary)["segments"];
  json["per_query"] = Json::array();
  for (const ReplayEntry& entry : report.entries) json["per_query"].push_back(EntryJson(entry));
  return json;
}

void PrintReplay(const RemoteMap& map, const ReplayReport& report, std::ostream& out) {
  PrintEntries(map, report, out);
  const Metrics metrics = Summarize(report.Errors());
  const std::vector<double> latencies_ms = report.LatenciesMs();
  out << "\n" << metrics.localized << " of " << metrics.queries << " localized, ";
  if (TellsDepthShares(map, report)) {
    out << *report.WithinDepthShare()
        << " within 1% of the scene's depth and 1 degree; median error "
        << FormatNumber(100.0 * report.MedianDepthShare().value_or(0.0), 2) << "% of the depth, ";
  } else {
    if (map.info.metric) out << metrics.wrong << " wrong; ";
    out << "median error " << FormatNumber(metrics.median_translation_error_m, 3)
        << (map.info.metric ? " m, " : " map units, ");
  }
  out << FormatNumber(metrics.median_rotation_error_deg, 3) << " deg\n";
  if (map.info.metric) {
    out << "recall";
    for (std::size_t i = 0; i < kRecallThresholds.size(); ++i) {
      out << "  " << kRecallThresholds[i].name << " " << FormatNumber(metrics.recall[i], 3);
    }
    out << "  auc " << FormatNumber(metrics.auc, 3) << "\n";
  }
  PrintInputFaults(report.CountInputFaults(), out);
  out << "latency p50 " << FormatNumber(Quantile(latencies_ms, 0.5), 1) << " ms, p99 "
      << FormatNumber(Quantile(latencies_ms, 0.99), 1) << " ms\n\n";
  PrintSummary(report.summary, out);
}

}  // namespace maploc
