// What the product answers to a problem: its own options, its own judgement (server/pipeline).
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "mapstore/model/matches.h"
#include "mapstore/model/strategy.h"
#include "server/ransac/estimator.h"
#include "server/trust/judge.h"
#include "tests/experiments/experiment.h"

namespace maploc::experiments {

struct JudgedAnswer {
  Verdict verdict;
  int iterations = 0;      // over both attempts
  Rigid3 camera_from_map;  // where verdict.confidence > 0
};

// As server/pipeline/localizer.cc answers a query about one segment: RANSAC with the product's
// defaults (10,000 iterations, 4 px, fallback on), refinement, the check of gravity, JudgePose for
// an image of 640 x 480 pixels; and where that is not LOCALIZED once more without gravity (P3P,
// 2,000 iterations), of which only a LOCALIZED answer is taken. With kP3P gravity is absent from
// the start. `min_iterations` keeps the search from stopping early.
JudgedAnswer AnswerAsProduct(const PoseProblem& problem, Strategy strategy, std::uint64_t seed,
                             int min_iterations = RansacOptions().min_iterations);

// "mixed-auto" and its like, and p3p: what the product itself answers with. INVALID_ARGUMENT for
// any other method.
Result<Strategy> ProductStrategy(const std::string& method);

}  // namespace maploc::experiments
