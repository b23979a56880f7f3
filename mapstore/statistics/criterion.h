// The selector's choice between predictions.
#pragma once

#include <array>

#include "mapstore/statistics/prediction.h"

namespace maploc {

// All three, best first by the criterion; what cannot succeed last.
std::array<Strategy, 3> RankStrategies(const StrategyPrediction& prediction,
                                       const SelectorOptions& options);

// `current`, or the one that beats it by the hysteresis; mixed where none can succeed.
Strategy ChooseStrategy(Strategy current, const StrategyPrediction& prediction,
                        const SelectorOptions& options);

}  // namespace maploc
