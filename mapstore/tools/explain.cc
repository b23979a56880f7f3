#include <cmath>
#include <iostream>

#include "mapstore/base/table.h"
#include "mapstore/base/text.h"
#include "mapstore/tools/commands.h"
#include "mapstore/tools/decline.h"
#include "mapstore/tools/output.h"
#include "mapstore/tools/readings.h"

namespace maploc {
namespace {

using Json = nlohmann::ordered_json;

struct ExplainFlags {
  std::string map;
  SegmentId segment = 0;
};

// JSON has no infinity: null is "never".
Json JsonTime(double time) { return std::isfinite(time) ? Json(time) : Json(nullptr); }

Json ToJson(const ExplainedRate& rate) {
  return {{"mean", rate.posterior.Mean()},
          {"credible_95", {rate.credible_95.low, rate.credible_95.high}},
          {"good", rate.good},
          {"total", rate.total},
          {"independent", rate.independent},
          {"posterior_a", rate.posterior.a},
          {"posterior_b", rate.posterior.b}};
}

Json ToJson(const StrategyOutlook& outlook, double cost) {
  return {{"success_probability", outlook.iteration_probability},
          {"expected_time_to_success", JsonTime(outlook.expected_time)},
          {"draw_probability", outlook.draw_probability},
          {"query_probability", outlook.query_probability},
          {"expected_iterations", outlook.expected_iterations},
          {"cost_of_iteration", cost}};
}

// Without p3p, which is no strategy to choose: it is drawn where there is no gravity.
Json DrawsToJson(const Explanation& e) {
  Json draws;
  for (const Strategy strategy : {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed}) {
    draws[std::string(StrategyName(strategy))] =
        ToJson(e.prediction.Of(strategy), CostOf(strategy, e.options));
  }
  return draws;
}

Json SwitchesToJson(const Explanation& e) {
  Json switches = Json::array();
  for (const StrategySwitch& change : e.switches) {
    switches.push_back({{"session", change.session},
                        {"session_start", UtcText(change.session_start_unix_ns)},
                        {"before", StrategyName(change.before)},
                        {"after", StrategyName(change.after.strategy)},
                        {"reason", change.after.reason}});
  }
  return switches;
}

Json HistoryToJson(const std::vector<DecisionRecord>& history) {
  Json decisions = Json::array();
  for (const DecisionRecord& record : history) {
    decisions.push_back({{"time_unix_ns", record.time_unix_ns},
                         {"time", UtcText(record.time_unix_ns)},
                         {"cause", record.cause},
                         {"strategy", StrategyName(record.decision.strategy)},
                         {"strategy_source", StrategySourceName(record.decision.source)},
                         {"predicted_success", record.decision.predicted_success},
                         {"localized", record.statistics.localized},
                         {"reason", record.decision.reason}});
  }
  return decisions;
}

Json RankingToJson(const std::array<Strategy, 3>& ranking) {
  Json names = Json::array();
  for (const Strategy strategy : ranking) names.push_back(StrategyName(strategy));
  return names;
}

Json ToJson(const ExplainedSegment& explained) {
  const Explanation& e = explained.explanation;
  const SelectorOptions& options = e.options;
  return {
      {"map", explained.map.name},
      {"version", explained.map.version},
      {"segment", explained.segment},
      {"strategy", StrategyName(e.decision.strategy)},
      {"strategy_source", StrategySourceName(e.decision.source)},
      {"ranking", RankingToJson(e.decision.ranking)},
      {"predicted_success", e.decision.predicted_success},
      {"reason", e.decision.reason},
      {"sessions", e.statistics.sessions},
      {"queries", e.statistics.queries},
      {"localized", e.statistics.localized},
      {"lambda", e.points.posterior.Mean()},
      {"gamma", e.usable_lines.posterior.Mean()},
      {"gamma_v", e.vertical_lines.posterior.Mean()},
      {"p", e.prediction.matches.points},
      {"l", e.prediction.matches.usable_lines},
      {"lv", e.prediction.matches.vertical_lines},
      {"vertical_lines_drawn",
       {{"1p1l", DrawsVerticalLines(Strategy::k1P1L, e.prediction.matches)},
        {"mixed", DrawsVerticalLines(Strategy::kMixed, e.prediction.matches)}}},
      {"rates",
       {{"points", ToJson(e.points)},
        {"usable_lines", ToJson(e.usable_lines)},
        {"vertical_lines", ToJson(e.vertical_lines)},
        {"success", ToJson(e.success)}}},
      {"draws", DrawsToJson(e)},
      {"choice",
       {{"criterion", options.criterion == StrategyCriterion::kPaper ? "paper" : "expected_time"},
        {"has_evidence", e.has_evidence},
        {"localized_by_weight", e.statistics.weighted_localized},
        {"localized_needed", options.min_localized_queries},
        {"best", StrategyName(e.best)},
        {"gain_of_best", e.gain_of_best},
        {"hysteresis", options.hysteresis}}},
      {"changes", ToJson(e.changes)},
      {"switches", SwitchesToJson(e)},
      {"decisions", HistoryToJson(explained.history)}};
}

void PrintHistory(const std::vector<DecisionRecord>& history) {
  Table table({"time (UTC)", "cause", "strategy", "source", "localized", "reason"});
  for (const DecisionRecord& record : history) {
    table.AddRow({UtcText(record.time_unix_ns), record.cause,
                  std::string(StrategyName(record.decision.strategy)),
                  std::string(StrategySourceName(record.decision.source)),
                  std::to_string(record.statistics.localized), record.decision.reason});
  }
  table.Print(std::cout);
}

Status Explain(const CommandContext& context, const ExplainFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const auto explained, ReadExplained(*store, flags.map, flags.segment));
  if (context.json) return PrintJson(ToJson(explained)), Status::Ok();
  std::cout << "Map " << explained.map.name << " version " << explained.map.version << ", segment "
            << explained.segment << "\n"
            << ExplanationText(explained.explanation) << "\n";
  PrintHistory(explained.history);
  return Status::Ok();
}

}  // namespace

void AddExplainCommand(CLI::App& app, CommandContext& context) {
  auto flags = std::make_shared<ExplainFlags>();
  CLI::App* command = AddCommand(app, context, "explain", "Tells why a segment uses its strategy",
                                 "maploc-map explain --store campus.db --map campus --segment 3",
                                 [&context, flags] { return Explain(context, *flags); });
  AddMapOption(*command, flags->map);
  AddSegmentOption(*command, flags->segment);
}

}  // namespace maploc
