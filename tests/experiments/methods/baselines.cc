#include <algorithm>

#include "tests/experiments/methods/cpu_timer.h"
#include "tests/experiments/methods/epnp.h"
#include "tests/experiments/methods/estimate.h"
#include "tests/experiments/methods/method.h"
#include "tests/experiments/methods/p2p1l.h"
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

// Two points and any line whose plane is seen.
int DrawAndSolve2p1l(const PreparedProblem& problem, Random& random, PoseMatrix* camera_from_map) {
  if (problem.points.size() < 2 || problem.lines.empty()) return 0;
  std::uint32_t drawn[2];
  DrawDistinct(static_cast<std::uint32_t>(problem.points.size()), 2, random, drawn);
  const PreparedLine& line =
      problem.lines[random.Below(static_cast<std::uint32_t>(problem.lines.size()))];
  if (!line.usable && !line.vertical) return 0;
  const PreparedPoint& first = problem.points[drawn[0]];
  const PreparedPoint& second = problem.points[drawn[1]];
  const Eigen::Vector3d rays[2] = {first.ray_in_camera, second.ray_in_camera};
  const Eigen::Vector3d points[2] = {first.position, second.position};
  Rigid3 poses[kMaxSolutions];
  const int count =
      SolveP2p1l(rays, points, line.plane_normal_in_camera, line.point, line.direction, poses);
  for (int i = 0; i < count; ++i) camera_from_map[i] = PoseMatrix(poses[i]);
  return count;
}

double Chance2p1l(int points, int point_inliers, int lines, int line_inliers) {
  return AllInliers(points, point_inliers, 2) * AllInliers(lines, line_inliers, 1);
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
  Method p2p1l;
  p2p1l.name = "2p1l";
  p2p1l.needs_lines = true;
  p2p1l.solve = [](const PoseProblem& problem, const MethodOptions& options) {
    return SolveBaseline(problem, options, DrawAndSolve2p1l, Chance2p1l);
  };
  return {p3p, epnp, p2p1l};
}

}  // namespace maploc::experiments
