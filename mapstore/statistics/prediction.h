// What each strategy promises in a segment: success and time, over what is known of its rates.
#pragma once

#include <array>

#include "mapstore/model/session.h"
#include "mapstore/statistics/beta.h"
#include "mapstore/statistics/probabilities.h"
#include "mapstore/statistics/selector_options.h"

namespace maploc {

// The strategies that the selector knows, in the order of preference between equals: mixed is the
// safe one.
inline constexpr std::array kSelectableStrategies = {Strategy::kMixed, Strategy::k2P,
                                                     Strategy::k1P1L};

// Of one iteration. REQUIRES: one of kSelectableStrategies.
double CostOf(Strategy strategy, const SelectorOptions& options);

// What is known of a segment's rates: Beta posteriors of the weak prior and the segment's
// independent matches at their (weighted) ratio.
struct RatePosteriors {
  BetaDistribution points;          // lambda
  BetaDistribution usable_lines;    // gamma
  BetaDistribution vertical_lines;  // gamma_v

  InlierRates Means() const;
};
RatePosteriors PosteriorsOf(const SegmentStatistics& statistics, const SelectorOptions& options);

// One strategy. Probabilities and iterations are expectations over the posteriors.
struct StrategyOutlook {
  double draw_probability = 0.0;       // of an all-inlier draw, at the posterior means
  double iteration_probability = 0.0;  // that one iteration leads to the pose
  double query_probability = 0.0;      // that one of max_iterations does
  double expected_iterations = 0.0;    // until one does, max_iterations where none does
  // cost x expected_iterations / query_probability: what is spent, failed queries with it, for
  // one that succeeds. Infinite for what cannot.
  double expected_time = 0.0;
};

struct StrategyPrediction {
  RatePosteriors rates;
  MatchCounts matches;  // of a query
  StrategyOutlook p1p1l;
  StrategyOutlook p2p;
  StrategyOutlook mixed;

  // REQUIRES: strategy is 1P1L, 2P or mixed.
  const StrategyOutlook& Of(Strategy strategy) const {
    return strategy == Strategy::k1P1L ? p1p1l : strategy == Strategy::k2P ? p2p : mixed;
  }
};

StrategyPrediction PredictStrategies(const SegmentStatistics& statistics,
                                     const SelectorOptions& options = {});

}  // namespace maploc
