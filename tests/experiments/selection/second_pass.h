// The second pass: every search to its end, and what that costs.
#pragma once

#include <cstdint>

#include "mapstore/geometry/camera.h"
#include "tests/experiments/selection/leave_one_out.h"

namespace maploc::selection {

// As the product searches a segment (server/pipeline/attempt.h): the decision's strategy for as
// long as Patience allows; where that finds nothing, or is up before the stop rule is content and
// the pose at hand is not one that the product would tell (JudgePose), the next of the ranking, to
// the limit. Iterations and times, judging included, are those of all strategies tried.
// `limits.fall_back` does not matter.
Attempt TryAsDecided(const PoseProblem& problem, const Camera& camera,
                     const StrategyDecision& decision, const SearchLimits& limits,
                     std::uint64_t seed);

// Fills in the searches to the end of the session that was left out (`set` and `session` are the
// same queries): of the strategies with the product's refinement, of the selection, of P3P.
// Strategies and selection run three times in turn, each time in another order (who comes first
// finds cold caches), and the median time counts; P3P, slower by far, runs once.
void RunSecondPass(const SetSession& set, const LeftOut& left_out, const TrialOptions& options,
                   SessionResult& session);

}  // namespace maploc::selection
