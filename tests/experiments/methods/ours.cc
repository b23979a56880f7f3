#include "server/ransac/estimator.h"
#include "server/refinement/refine.h"
#include "tests/experiments/methods/cpu_timer.h"
#include "tests/experiments/methods/estimate.h"
#include "tests/experiments/methods/method.h"

namespace maploc::experiments {

MethodAnswer EstimateAndRefine(const PoseProblem& problem, const MethodOptions& options,
                               Strategy strategy, Refinement refinement) {
  RansacOptions ransac;
  ransac.strategy = strategy;
  ransac.fall_back = false;
  ransac.max_reprojection_error_px = options.threshold_px;
  ransac.success_confidence = options.confidence;
  ransac.min_iterations = options.min_iterations;
  ransac.max_iterations = options.max_iterations;
  ransac.seed = options.seed;
  const CpuTimer timer;
  const Consensus consensus = EstimateConsensus(problem, ransac);
  MethodAnswer answer;
  answer.iterations = consensus.iterations;
  answer.ransac_ms = timer.ElapsedMs();
  if (consensus.found) {
    answer.camera_from_map = Refined(problem, consensus.camera_from_map, options, refinement);
  }
  answer.ms = timer.ElapsedMs();
  return answer;
}

std::optional<Rigid3> Refined(const PoseProblem& problem, const Rigid3& camera_from_map,
                              const MethodOptions& options, Refinement refinement) {
  RefineOptions refine;
  refine.mode = refinement;
  refine.pixel_sigma = options.pixel_sigma;
  refine.max_reprojection_error_px = options.threshold_px;
  const RefinedPose refined = RefinePose(problem, camera_from_map, refine);
  if (!refined.converged) return std::nullopt;
  return refined.camera_from_map;
}

std::vector<Method> OurMethods() {
  std::vector<Method> methods;
  for (const Strategy strategy : {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed}) {
    for (const Refinement refinement : {Refinement::k4Dof, Refinement::k6Dof, Refinement::kAuto}) {
      Method method;
      method.name =
          std::string(StrategyName(strategy)) + "-" + std::string(RefinementName(refinement));
      method.needs_lines = strategy == Strategy::k1P1L;
      method.solve = [strategy, refinement](const PoseProblem& problem,
                                            const MethodOptions& options) {
        return EstimateAndRefine(problem, options, strategy, refinement);
      };
      methods.push_back(method);
    }
  }
  return methods;
}

}  // namespace maploc::experiments
