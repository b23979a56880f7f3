#include "tests/experiments/selection/report.h"

#include <cmath>

#include "mapstore/tools/output.h"
#include "tests/experiments/selection/groups.h"

namespace maploc::selection {
namespace {

using Json = nlohmann::ordered_json;

Json IntervalJson(const Interval& interval) { return {interval.low, interval.high}; }

// AUC of every column; the selection's interval; and what it has over the best single strategy.
Json ScoresJson(const SelectionResult& result, const std::vector<ScoredQuery>& queries) {
  const std::uint64_t seed = result.flags.trials.seed;
  Json auc, recall;
  for (const int column : ColumnsOf(result)) {
    const Score score = ScoreOf(queries, column);
    auc[std::string(ColumnName(column))] = score.auc;
    recall[std::string(ColumnName(column))] = score.recall;
  }
  const int best = BestSingle(queries);
  return {{"queries", queries.size()},
          {"auc", auc},
          {"recall", recall},
          {"auc_95", IntervalJson(BootstrapSelection(queries, kSelection, seed))},
          {"best_single", ColumnName(best)},
          {"margin", ScoreOf(queries, kSelection).auc - ScoreOf(queries, best).auc},
          {"margin_95", IntervalJson(BootstrapSelection(queries, best, seed))}};
}

Json LongJson(const SelectionResult& result, const std::vector<ScoredQuery>& queries) {
  Json iterations, ms, recall;
  for (const int column : LongColumnsOf(result)) {
    const Score score = ScoreOf(queries, column);
    iterations[std::string(ColumnName(column))] = score.mean_long_iterations;
    ms[std::string(ColumnName(column))] = score.mean_long_ms;
    recall[std::string(ColumnName(column))] = score.long_recall;
  }
  return {{"mean_iterations", iterations}, {"mean_ms", ms}, {"recall_to_the_end", recall}};
}

Json SegmentJson(const SelectionResult& result, std::size_t session, SegmentId segment,
                 const SegmentChoice& choice) {
  const std::vector<ScoredQuery> own = QueriesIn(result, session, segment);
  Json auc;
  for (const Strategy strategy : kStrategies) {
    auc[std::string(StrategyName(strategy))] = ScoreOf(own, AutoMethodOf(strategy)).auc;
  }
  return {{"segment", segment},
          {"strategy", StrategyName(choice.decision.strategy)},
          {"strategy_source", StrategySourceName(choice.decision.source)},
          {"reason", choice.decision.reason},
          {"point_inlier_ratio", JsonRatio(choice.statistics.PointInlierRatio())},
          {"line_inlier_ratio", JsonRatio(choice.statistics.LineInlierRatio())},
          {"localized", choice.statistics.localized},
          {"queries", own.size()},
          {"auc", auc}};
}

Json SessionJson(const SelectionResult& result, std::size_t session) {
  const std::vector<ScoredQuery> queries = QueriesOf(result, session);
  Json document = {{"left_out", result.sessions[session].name}};
  document.update(ScoresJson(result, queries));
  document.update(LongJson(result, queries));
  Json segments = Json::array();
  for (const auto& [segment, choice] : result.left_out[session].segments) {
    segments.push_back(SegmentJson(result, session, segment, choice));
  }
  document["segments"] = std::move(segments);
  return document;
}

std::vector<experiments::ChartPoint> SuccessCurve(const std::vector<ScoredQuery>& queries,
                                                  int column) {
  std::vector<std::optional<PoseError>> errors;
  for (const auto& [query, selected] : queries) {
    const MethodResult& result = ResultOf(*query, column, selected);
    errors.insert(errors.end(), result.errors.begin(), result.errors.end());
  }
  std::vector<experiments::ChartPoint> curve;
  for (double threshold_m = 0.05; threshold_m < 5.01; threshold_m *= std::pow(100.0, 1.0 / 40.0)) {
    curve.push_back({threshold_m, Recall(errors, threshold_m, RotationThresholdDeg(threshold_m))});
  }
  return curve;
}

}  // namespace

nlohmann::ordered_json ToJson(const SelectionResult& result) {
  Json sessions = Json::array();
  for (std::size_t i = 0; i < result.sessions.size(); ++i) {
    sessions.push_back(SessionJson(result, i));
  }
  const std::vector<ScoredQuery> all = WholeOf(result);
  Json whole = ScoresJson(result, all);
  whole.update(LongJson(result, all));
  whole["structured"] = ScoresJson(result, WholeOf(result, Scene::kStructured));
  whole["unstructured"] = ScoresJson(result, WholeOf(result, Scene::kUnstructured));
  return {{"set", result.flags.set},
          {"seed", result.flags.trials.seed},
          {"trials", result.flags.trials.trials},
          {"sessions", std::move(sessions)},
          {"whole", std::move(whole)}};
}

experiments::Rows ToRows(const SelectionResult& result) {
  experiments::Rows rows;
  const std::vector<int> with_second_pass = LongColumnsOf(result);
  for (const NamedGroup& group : SessionsAndWhole(result)) {
    for (const int column : ColumnsOf(result)) {
      const Score score = ScoreOf(group.queries, column);
      experiments::Row row = {{"experiment", "selection"},
                              {"left_out", group.name},
                              {"method", ColumnName(column)},
                              {"trials", group.queries.size() * result.flags.trials.trials},
                              {"auc", score.auc}};
      for (std::size_t i = 0; i < score.recall.size(); ++i) {
        row["recall_" + std::string(kRecallThresholds[i].name)] = score.recall[i];
      }
      if (std::ranges::find(with_second_pass, column) != with_second_pass.end()) {
        row["mean_iterations"] = score.mean_long_iterations;
        row["mean_ms"] = score.mean_long_ms;
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

experiments::Chart SuccessChart(const SelectionResult& result) {
  experiments::Chart chart;
  chart.title = "Success after 100 iterations, a panel a session left out";
  chart.x_label = "threshold of translation, m (rotation: 2 to 10 degrees)";
  chart.y_label = "success";
  chart.log_x = true;
  chart.y_is_share = true;
  for (const NamedGroup& group : SessionsAndWhole(result)) {
    experiments::ChartPanel panel{group.name, {}};
    for (const int column : ColumnsOf(result)) {
      panel.series.push_back(
          {std::string(ColumnName(column)), SuccessCurve(group.queries, column)});
    }
    chart.panels.push_back(std::move(panel));
  }
  return chart;
}

}  // namespace maploc::selection
