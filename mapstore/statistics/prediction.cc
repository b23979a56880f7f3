#include "mapstore/statistics/prediction.h"

#include <algorithm>
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

// That at least one of `count` matches (a mean over queries) is right.
double AnyRight(double count, double rate) {
  return rate < 1.0 ? -std::expm1(count * std::log1p(-rate)) : (count > 0.0 ? 1.0 : 0.0);
}

// That exactly one is.
double OneRight(double count, double rate) {
  return rate < 1.0 ? count * rate * std::exp((count - 1.0) * std::log1p(-rate)) : 0.0;
}

// That two or more are.
double TwoRight(double count, double rate) {
  return count > 1.0 ? std::max(0.0, AnyRight(count, rate) - OneRight(count, rate)) : 0.0;
}

// That a query holds a right line for the strategy to draw: of the vertical ones, where they take
// part, it needs two.
double AnyLine(Strategy strategy, const MatchCounts& counts, const InlierRates& rates) {
  const double usable = AnyRight(counts.usable_lines, rates.usable_lines);
  if (!DrawsVerticalLines(strategy, counts)) return usable;
  return 1.0 - (1.0 - usable) * (1.0 - TwoRight(counts.vertical_lines, rates.vertical_lines));
}

// That a query's matches hold an all-inlier sample at all. A query has a whole number of right
// matches, drawn from the rates: with 8 lines at 0.2 one query in six has no right line, and 1P1L
// spends all its iterations there.
StrategyValues SamplesExist(const MatchCounts& counts, const InlierRates& rates) {
  const double any_point = AnyRight(counts.points, rates.points);
  const double two_points = TwoRight(counts.points, rates.points);
  return {any_point * AnyLine(Strategy::k1P1L, counts, rates), two_points,
          two_points + (any_point - two_points) * AnyLine(Strategy::kMixed, counts, rates)};
}

// Adds what a search of up to `most` iterations does, at rates of `weight` in the posterior: where
// a sample exists (with the probability `exists`) min(a geometric number, most) iterations, and
// `most` in vain where none does. `probability`: that an iteration succeeds, over both.
void AddSearch(double probability, double exists, double weight, double most,
               StrategyOutlook& outlook) {
  if (weight <= 0.0) return;
  const double there = exists > 0.0 ? std::min(probability / exists, 1.0) : 0.0;
  const double succeeds = there < 1.0 ? -std::expm1(most * std::log1p(-there)) : 1.0;
  outlook.iteration_probability += weight * probability;
  outlook.query_probability += weight * exists * succeeds;
  outlook.expected_iterations +=
      weight * (exists * (there > 0.0 ? succeeds / there : most) + (1.0 - exists) * most);
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
        const InlierRates rates = {points.node[i], usable.node[j], vertical.node[k]};
        const StrategyValues iteration =
            IterationProbabilities(prediction.matches, rates, options.yields);
        const StrategyValues exists = SamplesExist(prediction.matches, rates);
        AddSearch(iteration.p1p1l, exists.p1p1l, weight, most, prediction.p1p1l);
        AddSearch(iteration.p2p, exists.p2p, weight, most, prediction.p2p);
        AddSearch(iteration.mixed, exists.mixed, weight, most, prediction.mixed);
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

double CostOf(Strategy strategy, const SelectorOptions& options) {
  return StrategyValues{options.cost_1p1l, options.cost_2p, options.cost_mixed}.Of(strategy);
}

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
