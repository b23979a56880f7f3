// One strategy's search for the best pose: draw, pre-test, score, optimize locally, stop.
#pragma once

#include "server/ransac/estimator.h"
#include "server/ransac/prepared_problem.h"
#include "server/ransac/sampler.h"

namespace maploc {

struct SearchResult {
  PoseMatrix camera_from_centred;
  Support support;  // score 0: nothing was found
  int iterations = 0;
  bool drawn = false;  // the strategy has a sample in this problem
  bool interrupted = false;
};

// Deterministic for one state of `random`.
SearchResult SearchConsensus(const PreparedProblem& prepared, const RansacOptions& options,
                             Strategy strategy, Random& random);

}  // namespace maploc
