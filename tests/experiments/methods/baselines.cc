#include <cmath>

#include "tests/experiments/methods/cpu_timer.h"
#include "tests/experiments/methods/epnp.h"
#include "tests/experiments/methods/estimate.h"
#include "tests/experiments/methods/method.h"
#include "tests/experiments/methods/simple_ransac.h"

namespace maploc::experiments {
namespace {

MethodAnswer SolveBaseline(const PoseProblem& problem, const MethodOptions& options,
                           const DrawAndSolve& draw, const DrawChance& chance) {
  const CpuTimer timer;
  MethodAnswer answer;
  const std::optional<Rigid3> found =
      SimpleRansac(problem, options, draw, chance, &answer.iterations);
  answer.ransac_ms = timer.ElapsedMs();
  if (found) answer.camera_from_map = Refined(problem, *found, options, Refinement::k6Dof);
  answer.ms = timer.ElapsedMs();
  return answer;
}

// That `drawn` different ones of `size` are all among the `inliers`.
double AllInliers(int size, int inliers, int drawn) {
  double chance = 1.0;
  for (int i = 0; i < drawn; ++i) {
    chance *= size > i ? std::max(0.0, static_cast<double>(inliers - i)) / (size - i) : 0.0;
  }
  return chance;
}

double EpnpChance(int points, int point_inliers, int, int) {
  return AllInliers(points, point_inliers, std::min(points, kEpnpSample));
}

}  // namespace

std::vector<Method> BaselineMethods() {
  Method p3p;
  p3p.name = "p3p";
  p3p.solve = [](const PoseProblem& problem, const MethodOptions& options) {
    return EstimateAndRefine(problem, options, Strategy::kP3P, Refinement::k6Dof);
  };
  Method epnp;
  epnp.name = "epnp";
  epnp.solve = [](const PoseProblem& problem, const MethodOptions& options) {
    return SolveBaseline(problem, options, DrawAndSolveEpnp, EpnpChance);
  };
  return {p3p, epnp};
}

}  // namespace maploc::experiments
