// The 2-entity RANSAC: a PoseProblem in, a consensus out. Strategy and its fallback are here; the
// refined pose and its judgement come after (server/refinement, server/pipeline).
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "mapstore/base/clock.h"
#include "mapstore/base/random.h"
#include "mapstore/geometry/rigid3.h"
#include "mapstore/model/matches.h"
#include "mapstore/model/strategy.h"

namespace maploc {

struct RansacOptions {
  Strategy strategy = Strategy::kMixed;
  bool fall_back = true;  // to `fallbacks` where the strategy cannot be drawn or finds nothing
  // Tried in this order, each once; a segment's ranking of strategies belongs here. P3P falls back
  // to nothing: it is asked for where gravity is not to be used.
  std::vector<Strategy> fallbacks = {Strategy::kMixed, Strategy::k2P};
  double max_reprojection_error_px = 4.0;  // inlier threshold for points and for lines' end points
  double success_confidence = 0.999;  // stop when a better consensus is less probable than 1 - this
  int min_iterations = 20;
  int max_iterations = 10000;  // evaluated hypotheses a strategy
  std::uint64_t seed = 1;
  Deadline deadline = kNoDeadline;
  const std::atomic<bool>* cancelled = nullptr;  // polled; may be null
};

struct Consensus {
  bool found = false;
  Rigid3 camera_from_map;
  std::vector<std::uint8_t> point_inliers;  // one a point correspondence, 0 or 1
  std::vector<std::uint8_t> line_inliers;
  double score = 0.0;                    // of the search's pose (scoring.h); larger is better
  Strategy strategy = Strategy::kMixed;  // that found it, or was tried last
  bool fell_back = false;
  std::int32_t iterations = 0;  // evaluated hypotheses, over all strategies tried
  bool interrupted = false;     // by the deadline or the cancel flag
};

// The same problem, options and seed give the same result. Thread-safe.
// REQUIRES: problem.has_gravity unless strategy is kP3P.
Consensus EstimateConsensus(const PoseProblem& problem, const RansacOptions& options);

}  // namespace maploc
