#include "mapstore/statistics/prediction.h"

#include <cmath>
#include <limits>

namespace maploc {
namespace {

BetaDistribution Posterior(double inliers, double matches, double independent,
                           const SelectorOptions& options) {
  const double ratio = matches > 0.0 ? inliers / matches : 0.0;
  const double count = matches > 0.0 ? independent : 0.0;
  return {options.prior_matches * options.prior_inlier_ratio + count * ratio,
          options.prior_matches * (1.0 - options.prior_inlier_ratio) + count * (1.0 - ratio)};
}

double CostOf(Strategy strategy, const SelectorOptions& options) {
  return StrategyValues{options.cost_1p1l, options.cost_2p, options.cost_mixed}.Of(strategy);
}

// Adds what a search of up to `most` iterations does where one succeeds with `probability`, which
// itself has `weight`: min(a geometric number, most) iterations.
void AddSearch(double probability, double weight, double most, StrategyOutlook& outlook) {
  if (weight <= 0.0) return;
  const double succeeds = probability < 1.0 ? -std::expm1(most * std::log1p(-probability)) : 1.0;
  outlook.iteration_probability += weight * probability;
  outlook.query_probability += weight * succeeds;
  outlook.expected_iterations += weight * (probability > 0.0 ? succeeds / probability : most);
}

// Expectations over independent posteriors, by the product of their quadratures.
void Integrate(const SelectorOptions& options, StrategyPrediction& prediction) {
  const BetaQuadrature points = QuadratureOf(prediction.rates.points);
  const BetaQuadrature usable = QuadratureOf(prediction.rates.usable_lines);
  BetaQuadrature vertical;
  int vertical_nodes = 1;  // where mixed does not draw them, 1P1L does not either
  if (DrawsVerticalLines(Strategy::kMixed, prediction.matches)) {
    vertical = QuadratureOf(prediction.rates.vertical_lines);
    vertical_nodes = kBetaNodes;
  } else {
    vertical.node.fill(0.0);
    vertical.weight.fill(1.0);
  }
  const double most = static_cast<double>(options.max_iterations);
  for (int i = 0; i < kBetaNodes; ++i) {
    for (int j = 0; j < kBetaNodes; ++j) {
      for (int k = 0; k < vertical_nodes; ++k) {
        const double weight = points.weight[i] * usable.weight[j] * vertical.weight[k];
        const StrategyValues iteration = IterationProbabilities(
            prediction.matches, {points.node[i], usable.node[j], vertical.node[k]}, options.yields);
        AddSearch(iteration.p1p1l, weight, most, prediction.p1p1l);
        AddSearch(iteration.p2p, weight, most, prediction.p2p);
        AddSearch(iteration.mixed, weight, most, prediction.mixed);
      }
    }
  }
}

void Finish(double draw_probability, double cost, StrategyOutlook& outlook) {
  outlook.draw_probability = draw_probability;
  outlook.expected_time = outlook.query_probability > 0.0
                              ? cost * outlook.expected_iterations / outlook.query_probability
                              : std::numeric_limits<double>::infinity();
}

}  // namespace

InlierRates RatePosteriors::Means() const {
  return {points.Mean(), usable_lines.Mean(), vertical_lines.Mean()};
}

RatePosteriors PosteriorsOf(const SegmentStatistics& s, const SelectorOptions& options) {
  return {
      Posterior(s.point_inliers, s.point_matches, s.independent_points, options),
      Posterior(s.usable_line_inliers, s.usable_line_matches, s.independent_usable_lines, options),
      Posterior(s.vertical_line_inliers, s.vertical_line_matches, s.independent_vertical_lines,
                options)};
}

StrategyPrediction PredictStrategies(const SegmentStatistics& statistics,
                                     const SelectorOptions& options) {
  StrategyPrediction prediction;
  prediction.rates = PosteriorsOf(statistics, options);
  prediction.matches = {statistics.typical_point_matches, statistics.typical_usable_line_matches,
                        statistics.typical_vertical_line_matches};
  Integrate(options, prediction);
  const StrategyValues draw = DrawProbabilities(prediction.matches, prediction.rates.Means());
  Finish(draw.p1p1l, CostOf(Strategy::k1P1L, options), prediction.p1p1l);
  Finish(draw.p2p, CostOf(Strategy::k2P, options), prediction.p2p);
  Finish(draw.mixed, CostOf(Strategy::kMixed, options), prediction.mixed);
  return prediction;
}

}  // namespace maploc
