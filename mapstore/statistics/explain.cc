#include "mapstore/statistics/explain.h"

#include <cmath>

#include "mapstore/statistics/criterion.h"

namespace maploc {
namespace {

ExplainedRate ExplainRate(double good, double total, double independent,
                          const BetaDistribution& posterior) {
  return {good, total, independent, posterior, CredibleInterval(posterior, 0.95)};
}

ExplainedRate ExplainSuccess(std::span<const SegmentSessionRow> rows,
                             const SegmentStatistics& statistics, const SelectorOptions& options) {
  // As many independent trials a query as the sessions' own counts have, at the weighted share.
  Proportion sum;
  for (const SegmentSessionRow& row : rows) {
    AddTo(sum, ProportionOf(ChangeKind::kSuccess, row, options.statistics));
  }
  const double independent =
      sum.total > 0.0 ? statistics.weighted_queries * sum.independent / sum.total : 0.0;
  const double share = statistics.weighted_queries > 0.0
                           ? statistics.weighted_localized / statistics.weighted_queries
                           : 0.0;
  return ExplainRate(statistics.weighted_localized, statistics.weighted_queries, independent,
                     {0.5 + independent * share, 0.5 + independent * (1.0 - share)});
}

// Of the time that `than` needs, the share that `strategy` saves.
double GainOver(Strategy than, Strategy strategy, const StrategyPrediction& prediction) {
  const double time = prediction.Of(strategy).expected_time;
  const double than_time = prediction.Of(than).expected_time;
  if (strategy == than || !std::isfinite(time)) return 0.0;
  return std::isfinite(than_time) ? 1.0 - time / than_time : 1.0;
}

}  // namespace

Explanation ExplainStrategy(std::span<const SegmentSessionRow> rows,
                            const StrategyDecision& in_force, const SelectorOptions& options) {
  SelectorFold fold(options);
  for (const SegmentSessionRow& row : rows) fold.Add(row);
  Explanation explanation;
  explanation.options = options;
  explanation.decision = in_force;
  explanation.statistics = fold.statistics().Value();
  explanation.has_evidence = fold.HasEvidence();
  const SegmentStatistics& s = explanation.statistics;
  explanation.prediction = fold.prediction();
  const RatePosteriors& rates = explanation.prediction.rates;
  explanation.points =
      ExplainRate(s.point_inliers, s.point_matches, s.independent_points, rates.points);
  explanation.usable_lines = ExplainRate(s.usable_line_inliers, s.usable_line_matches,
                                         s.independent_usable_lines, rates.usable_lines);
  explanation.vertical_lines = ExplainRate(s.vertical_line_inliers, s.vertical_line_matches,
                                           s.independent_vertical_lines, rates.vertical_lines);
  explanation.success = ExplainSuccess(rows, s, options);
  explanation.best = RankStrategies(explanation.prediction, options).front();
  explanation.gain_of_best = GainOver(fold.current(), explanation.best, explanation.prediction);
  explanation.switches = ListSwitches(rows, options);
  explanation.changes = FindChanges(rows, options.statistics);
  return explanation;
}

}  // namespace maploc
