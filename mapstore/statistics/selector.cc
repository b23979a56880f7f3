#include "mapstore/statistics/selector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace maploc {
namespace {

// In the order of preference between equals: mixed is the safe one.
constexpr std::array kCandidates = {Strategy::kMixed, Strategy::k2P, Strategy::k1P1L};

double CostOf(Strategy strategy, const SelectorOptions& options) {
  switch (strategy) {
    case Strategy::k1P1L:
      return options.cost_1p1l;
    case Strategy::k2P:
      return options.cost_2p;
    default:
      return options.cost_mixed;
  }
}

double PosteriorMean(double inliers, double matches, const SelectorOptions& options) {
  const double total = matches + options.prior_matches;
  if (total <= 0.0) return options.prior_inlier_ratio;
  return (inliers + options.prior_matches * options.prior_inlier_ratio) / total;
}

// The current strategy, or the one that beats it by the hysteresis; mixed where none can succeed.
Strategy Choose(Strategy current, const StrategyPrediction& prediction,
                const SelectorOptions& options) {
  Strategy best = kCandidates.front();
  for (const Strategy candidate : kCandidates) {
    if (prediction.ExpectedTimeOf(candidate, options) < prediction.ExpectedTimeOf(best, options)) {
      best = candidate;
    }
  }
  const double current_time = prediction.ExpectedTimeOf(current, options);
  const double best_time = prediction.ExpectedTimeOf(best, options);
  if (std::isinf(best_time)) return Strategy::kMixed;
  return best_time < (1.0 - options.hysteresis) * current_time ? best : current;
}

std::array<Strategy, 3> RankByTime(const StrategyPrediction& prediction,
                                   const SelectorOptions& options) {
  std::array<Strategy, 3> ranking = kCandidates;
  std::stable_sort(ranking.begin(), ranking.end(), [&](Strategy a, Strategy b) {
    return prediction.ExpectedTimeOf(a, options) < prediction.ExpectedTimeOf(b, options);
  });
  return ranking;
}

std::string Describe(Strategy strategy, const StrategyPrediction& prediction,
                     const SegmentStatistics& statistics) {
  std::array<char, 320> text;
  std::snprintf(text.data(), text.size(),
                "%s: a draw succeeds with 1p1l %.4f, 2p %.4f, mixed %.4f (points: %.1f a query at "
                "%.3f; usable lines: %.1f at %.3f; %lld localized queries in %lld sessions)",
                std::string(StrategyName(strategy)).c_str(), prediction.draw.p1p1l,
                prediction.draw.p2p, prediction.draw.mixed, prediction.point_matches,
                prediction.point_inlier_ratio, prediction.usable_line_matches,
                prediction.usable_line_inlier_ratio, static_cast<long long>(statistics.localized),
                static_cast<long long>(statistics.sessions));
  return text.data();
}

StrategyDecision WithoutEvidence(const SegmentStatistics& statistics,
                                 const SelectorOptions& options) {
  return {Strategy::kMixed, StrategySource::kDefault,
          "mixed until there is evidence: " + std::to_string(statistics.localized) + " of " +
              std::to_string(options.min_localized_queries) + " localized queries",
          0.0, kCandidates};
}

}  // namespace

DrawProbabilities ComputeDrawProbabilities(double p, double l, double lambda, double gamma) {
  DrawProbabilities draw;
  if (p >= 1.0 && l >= 1.0) draw.p1p1l = std::clamp(lambda * gamma, 0.0, 1.0);
  if (p >= 2.0) draw.p2p = std::clamp(lambda * (lambda * p - 1.0) / (p - 1.0), 0.0, 1.0);
  if (p >= 1.0 && p + l >= 2.0) {
    draw.mixed = std::clamp(lambda * (lambda * p + gamma * l - 1.0) / (p + l - 1.0), 0.0, 1.0);
  }
  return draw;
}

double StrategyPrediction::ProbabilityOf(Strategy strategy) const {
  switch (strategy) {
    case Strategy::k1P1L:
      return draw.p1p1l;
    case Strategy::k2P:
      return draw.p2p;
    default:
      return draw.mixed;
  }
}

double StrategyPrediction::ExpectedTimeOf(Strategy strategy, const SelectorOptions& options) const {
  const double probability = ProbabilityOf(strategy);
  if (probability <= 0.0) return std::numeric_limits<double>::infinity();
  return CostOf(strategy, options) / probability;
}

StrategyPrediction PredictStrategies(const SegmentStatistics& statistics,
                                     const SelectorOptions& options) {
  StrategyPrediction prediction;
  prediction.point_inlier_ratio =
      PosteriorMean(statistics.point_inliers, statistics.point_matches, options);
  prediction.usable_line_inlier_ratio =
      PosteriorMean(statistics.usable_line_inliers, statistics.usable_line_matches, options);
  prediction.point_matches = statistics.typical_point_matches;
  prediction.usable_line_matches = statistics.typical_usable_line_matches;
  prediction.draw =
      ComputeDrawProbabilities(prediction.point_matches, prediction.usable_line_matches,
                               prediction.point_inlier_ratio, prediction.usable_line_inlier_ratio);
  return prediction;
}

std::array<Strategy, 3> RankAfter(Strategy first, std::array<Strategy, 3> ranking) {
  const auto found = std::find(ranking.begin(), ranking.end(), first);
  std::rotate(ranking.begin(), found, found + 1);
  return ranking;
}

StrategyDecision SelectStrategy(std::span<const SegmentSessionRow> rows,
                                const SelectorOptions& options) {
  StatisticsFold fold(options.statistics);
  Strategy current = Strategy::kMixed;
  for (const SegmentSessionRow& row : rows) {
    fold.Add(row);
    const SegmentStatistics statistics = fold.Value();
    if (statistics.localized < options.min_localized_queries) continue;
    current = Choose(current, PredictStrategies(statistics, options), options);
  }
  const SegmentStatistics statistics = fold.Value();
  if (statistics.localized < options.min_localized_queries) {
    return WithoutEvidence(statistics, options);
  }
  const StrategyPrediction prediction = PredictStrategies(statistics, options);
  return {current, StrategySource::kLearned, Describe(current, prediction, statistics),
          prediction.ProbabilityOf(current), RankAfter(current, RankByTime(prediction, options))};
}

}  // namespace maploc
