#include "server/ransac/estimator.h"

#include <algorithm>
#include <utility>

#include "server/ransac/search.h"

namespace maploc {
namespace {

// A pose that explains no more than its own sample explains nothing.
int MinInliers(Strategy strategy) { return strategy == Strategy::kP3P ? 4 : 3; }

// The strategy, then its fallbacks: each once.
std::vector<Strategy> StrategiesToTry(const RansacOptions& options) {
  std::vector<Strategy> strategies = {options.strategy};
  if (!options.fall_back || options.strategy == Strategy::kP3P) return strategies;
  for (const Strategy next : options.fallbacks) {
    if (std::find(strategies.begin(), strategies.end(), next) == strategies.end()) {
      strategies.push_back(next);
    }
  }
  return strategies;
}

// Takes the pose of a search if enough features agree with it. They are counted anew, in double
// precision and the map's own frame; the search scored in single precision about the centroid.
void Adopt(const PoseProblem& problem, const PreparedProblem& prepared,
           const RansacOptions& options, const SearchResult& search, Strategy strategy,
           Consensus* consensus) {
  const Rigid3 pose = UncentredPose(prepared, search.camera_from_centred);
  InlierFlags inliers = FindInliers(problem, pose, options.max_reprojection_error_px);
  if (inliers.count < MinInliers(strategy)) return;
  consensus->found = true;
  consensus->camera_from_map = pose;
  consensus->point_inliers = std::move(inliers.points);
  consensus->line_inliers = std::move(inliers.lines);
  consensus->score = search.support.score;
}

}  // namespace

Consensus EstimateConsensus(const PoseProblem& problem, const RansacOptions& options) {
  Consensus consensus;
  consensus.strategy = options.strategy;
  consensus.point_inliers.assign(problem.points.size(), 0);
  consensus.line_inliers.assign(problem.lines.size(), 0);
  if (!problem.has_gravity && options.strategy != Strategy::kP3P) return consensus;
  Random random(options.seed);
  const PreparedProblem prepared = PrepareProblem(problem, random);
  for (const Strategy strategy : StrategiesToTry(options)) {
    const SearchResult search = SearchConsensus(prepared, options, strategy, random);
    consensus.iterations += search.iterations;
    consensus.interrupted = search.interrupted;
    // A strategy that has no sample in this problem was not tried, and is not reported.
    if (search.drawn) {
      consensus.strategy = strategy;
      consensus.fell_back = strategy != options.strategy;
    }
    if (search.support.score > 0) {
      Adopt(problem, prepared, options, search, strategy, &consensus);
    }
    if (consensus.found || consensus.interrupted) break;
  }
  return consensus;
}

}  // namespace maploc
