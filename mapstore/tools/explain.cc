#include <array>
#include <cmath>
#include <iostream>

#include "mapstore/tools/commands.h"
#include "mapstore/tools/output.h"

namespace maploc {
namespace {

constexpr std::array kSelectable = {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed};

struct ExplainFlags {
  std::string map;
  SegmentId segment = 0;
};

nlohmann::ordered_json JsonTime(double time) {
  return std::isfinite(time) ? nlohmann::ordered_json(time) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json ToJson(const MapKey& key, const SegmentSummary& segment,
                              const std::vector<DecisionRecord>& history) {
  const StrategyPrediction prediction = PredictStrategies(segment.statistics, segment.selector);
  nlohmann::ordered_json draws;
  for (const Strategy strategy : kSelectable) {
    draws[std::string(StrategyName(strategy))] = {
        {"success_probability", prediction.ProbabilityOf(strategy)},
        {"expected_time_to_success",
         JsonTime(prediction.ExpectedTimeOf(strategy, segment.selector))}};
  }
  auto decisions = nlohmann::ordered_json::array();
  for (const DecisionRecord& record : history) {
    decisions.push_back({{"time_unix_ns", record.time_unix_ns},
                         {"cause", record.cause},
                         {"strategy", StrategyName(record.decision.strategy)},
                         {"strategy_source", StrategySourceName(record.decision.source)},
                         {"reason", record.decision.reason}});
  }
  return {{"map", key.name},
          {"version", key.version},
          {"segment", segment.id},
          {"strategy", StrategyName(segment.decision.strategy)},
          {"strategy_source", StrategySourceName(segment.decision.source)},
          {"reason", segment.decision.reason},
          {"lambda", prediction.point_inlier_ratio},
          {"gamma", prediction.usable_line_inlier_ratio},
          {"p", prediction.point_matches},
          {"l", prediction.usable_line_matches},
          {"draws", std::move(draws)},
          {"decisions", std::move(decisions)}};
}

void PrintText(const SegmentSummary& segment, const std::vector<DecisionRecord>& history) {
  const SelectorOptions& options = segment.selector;
  const StrategyPrediction prediction = PredictStrategies(segment.statistics, options);
  std::cout << "Segment " << segment.id << " uses " << StrategyName(segment.decision.strategy)
            << " (" << StrategySourceName(segment.decision.source)
            << "): " << segment.decision.reason << "\n\nlambda "
            << FormatNumber(prediction.point_inlier_ratio, 3) << ", gamma "
            << FormatNumber(prediction.usable_line_inlier_ratio, 3) << " (posterior means); p "
            << FormatNumber(prediction.point_matches, 1) << ", l "
            << FormatNumber(prediction.usable_line_matches, 1) << " matches a query\n\n";
  Table draws({"strategy", "a draw succeeds", "expected time to success"});
  for (const Strategy strategy : kSelectable) {
    const double time = prediction.ExpectedTimeOf(strategy, options);
    draws.AddRow({std::string(StrategyName(strategy)),
                  FormatNumber(prediction.ProbabilityOf(strategy), 4),
                  std::isfinite(time) ? FormatNumber(time, 2) : "never"});
  }
  draws.Print(std::cout);
  std::cout << "\nIt leaves mixed after " << options.min_localized_queries
            << " localized queries and changes for a gain of "
            << FormatNumber(100.0 * options.hysteresis, 0) << "%.\n\n";
  Table decisions({"cause", "strategy", "source", "localized", "reason"});
  for (const DecisionRecord& record : history) {
    decisions.AddRow({record.cause, std::string(StrategyName(record.decision.strategy)),
                      std::string(StrategySourceName(record.decision.source)),
                      std::to_string(record.statistics.localized), record.decision.reason});
  }
  decisions.Print(std::cout);
}

Status Explain(const CommandContext& context, const ExplainFlags& flags) {
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenExistingStore(context));
  MAPLOC_ASSIGN_OR_RETURN(const MapSummary map, store->GetMap(flags.map));
  const MapKey& key = map.info.key;
  MAPLOC_ASSIGN_OR_RETURN(const SegmentSummary segment, store->GetSegment(key, flags.segment));
  MAPLOC_ASSIGN_OR_RETURN(const auto history, store->ListDecisions(key, flags.segment));
  if (context.json) return PrintJson(ToJson(key, segment, history)), Status::Ok();
  PrintText(segment, history);
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
