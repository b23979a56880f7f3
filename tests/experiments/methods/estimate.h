// The product's estimator as a method, and its refinement for whoever found the pose.
#pragma once

#include <optional>

#include "mapstore/model/strategy.h"
#include "tests/experiments/methods/method.h"

namespace maploc::experiments {

// EstimateConsensus of one strategy, no fallback, then RefinePose.
MethodAnswer EstimateAndRefine(const PoseProblem& problem, const MethodOptions& options,
                               Strategy strategy, Refinement refinement);

// RefinePose alone; nullopt where it does not converge.
std::optional<Rigid3> Refined(const PoseProblem& problem, const Rigid3& camera_from_map,
                              const MethodOptions& options, Refinement refinement);

}  // namespace maploc::experiments
