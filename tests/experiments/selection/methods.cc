#include "tests/experiments/selection/methods.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "server/ransac/estimator.h"
#include "tests/experiments/methods/cpu_timer.h"
#include "tests/experiments/methods/method.h"

namespace maploc::selection {
namespace {

using experiments::CpuTimer;

constexpr std::array kRefinements = {Refinement::k4Dof, Refinement::k6Dof, Refinement::kAuto};
constexpr int kAuto = 2;

RansacOptions ToRansacOptions(Strategy strategy, const SearchLimits& limits, std::uint64_t seed) {
  RansacOptions options;
  options.strategy = strategy;
  options.fall_back = limits.fall_back;
  options.success_confidence = limits.confidence;
  options.max_iterations = limits.max_iterations;
  options.min_iterations = std::min(options.min_iterations, limits.max_iterations);
  options.seed = seed;
  return options;
}

Attempt Search(const PoseProblem& problem, Strategy strategy, const SearchLimits& limits,
               std::uint64_t seed) {
  const CpuTimer timer;
  const Consensus consensus = EstimateConsensus(problem, ToRansacOptions(strategy, limits, seed));
  Attempt attempt;
  attempt.iterations = consensus.iterations;
  if (consensus.found) attempt.camera_from_map = consensus.camera_from_map;
  attempt.search_ms = timer.ElapsedMs();
  attempt.ms = attempt.search_ms;
  return attempt;
}

// A pose that does not converge is no answer, as in the pipeline.
Attempt Refined(const PoseProblem& problem, Attempt attempt, Refinement mode) {
  if (!attempt.camera_from_map) return attempt;
  const CpuTimer timer;
  RefineOptions options;
  options.mode = mode;
  RefinedPose pose = RefinePose(problem, *attempt.camera_from_map, options);
  attempt.ms += timer.ElapsedMs();
  attempt.camera_from_map.reset();
  if (pose.converged) attempt.camera_from_map = pose.camera_from_map;
  attempt.refined = std::move(pose);
  return attempt;
}

// What the classical methods know: points.
PoseProblem PointsAlone(const PoseProblem& problem) {
  PoseProblem points = problem;
  points.lines.clear();
  points.has_gravity = false;
  return points;
}

Attempt TryBaseline(int method, const PoseProblem& problem, const SearchLimits& limits,
                    std::uint64_t seed) {
  experiments::MethodOptions options;
  options.threshold_px = RansacOptions{}.max_reprojection_error_px;
  options.confidence = limits.confidence;
  options.max_iterations = limits.max_iterations;
  options.min_iterations = std::min(options.min_iterations, limits.max_iterations);
  options.seed = seed;
  const experiments::MethodAnswer answer =
      experiments::MethodByName(kMethods[method]).solve(PointsAlone(problem), options);
  return {answer.camera_from_map, answer.iterations, answer.ransac_ms, answer.ms, {}};
}

}  // namespace

int AutoMethodOf(Strategy strategy) {
  const auto found = std::ranges::find(kStrategies, strategy);
  return static_cast<int>(found - kStrategies.begin()) * static_cast<int>(kRefinements.size()) +
         kAuto;
}

std::vector<Attempt> TryAllMethods(const PoseProblem& problem, const SearchLimits& limits,
                                   std::uint64_t seed) {
  std::vector<Attempt> attempts(kMethods.size());
  std::size_t method = 0;
  for (const Strategy strategy : kStrategies) {
    const Attempt search = Search(problem, strategy, limits, seed);
    for (const Refinement mode : kRefinements) attempts[method++] = Refined(problem, search, mode);
  }
  attempts[kP3pMethod] = TryP3p(problem, limits, seed);
  attempts[kEpnpMethod] = TryBaseline(kEpnpMethod, problem, limits, seed);
  return attempts;
}

Attempt TryStrategy(const PoseProblem& problem, Strategy strategy, const SearchLimits& limits,
                    std::uint64_t seed) {
  return Refined(problem, Search(problem, strategy, limits, seed), Refinement::kAuto);
}

Attempt TryP3p(const PoseProblem& problem, const SearchLimits& limits, std::uint64_t seed) {
  return TryBaseline(kP3pMethod, problem, limits, seed);
}

}  // namespace maploc::selection
