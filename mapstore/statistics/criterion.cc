#include "mapstore/statistics/criterion.h"

#include <algorithm>
#include <cmath>

namespace maploc {
namespace {

using Ranking = std::array<Strategy, 3>;

Ranking RankByTime(const StrategyPrediction& prediction) {
  Ranking ranking = kSelectableStrategies;
  std::stable_sort(ranking.begin(), ranking.end(), [&](Strategy a, Strategy b) {
    return prediction.Of(a).expected_time < prediction.Of(b).expected_time;
  });
  return ranking;
}

bool CanSucceed(Strategy strategy, const StrategyPrediction& prediction) {
  return std::isfinite(prediction.Of(strategy).expected_time);
}

// gamma >= lambda: 1P1L, else 2P; each rate is multiplied by its factor before. gamma is the share
// of right lines among those that 1P1L draws. What cannot be drawn stands back, mixed is between.
Ranking RankByPaper(const StrategyPrediction& prediction, double lambda_factor,
                    double gamma_factor) {
  const double lambda = prediction.rates.Means().points;
  const double gamma = lambda > 0.0 ? prediction.p1p1l.draw_probability / lambda : 0.0;
  Ranking ranking = {Strategy::k2P, Strategy::kMixed, Strategy::k1P1L};
  if (gamma_factor * gamma >= lambda_factor * lambda) std::swap(ranking.front(), ranking.back());
  std::stable_partition(ranking.begin(), ranking.end(),
                        [&](Strategy strategy) { return CanSucceed(strategy, prediction); });
  return ranking;
}

// Whoever is in force is measured by the others' rate less the hysteresis.
Strategy ChooseByPaper(Strategy current, const StrategyPrediction& prediction, double hysteresis) {
  const double less = 1.0 - hysteresis;
  return RankByPaper(prediction, current == Strategy::k1P1L ? less : 1.0,
                     current == Strategy::k2P ? less : 1.0)
      .front();
}

}  // namespace

std::array<Strategy, 3> RankStrategies(const StrategyPrediction& prediction,
                                       const SelectorOptions& options) {
  if (options.criterion == StrategyCriterion::kPaper) return RankByPaper(prediction, 1.0, 1.0);
  return RankByTime(prediction);
}

Strategy ChooseStrategy(Strategy current, const StrategyPrediction& prediction,
                        const SelectorOptions& options) {
  const Strategy best = RankStrategies(prediction, options).front();
  if (!CanSucceed(best, prediction)) return Strategy::kMixed;
  if (options.criterion == StrategyCriterion::kPaper) {
    return ChooseByPaper(current, prediction, options.hysteresis);
  }
  const double current_time = prediction.Of(current).expected_time;
  const double best_time = prediction.Of(best).expected_time;
  return best_time < (1.0 - options.hysteresis) * current_time ? best : current;
}

}  // namespace maploc
