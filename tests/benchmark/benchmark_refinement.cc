// Refinement and confidence of a pose: points and half as many lines, gravity to half a degree.
#include <numbers>

#include <benchmark/benchmark.h>

#include "server/refinement/refine.h"
#include "server/trust/confidence.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

SyntheticProblem Make(int points) {
  Random random(1);
  SyntheticOptions options;
  options.point_inliers = points;
  options.point_outliers = points;
  options.line_inliers = points / 2;
  options.line_outliers = points / 2;
  options.gravity_noise_rad = options.gravity_sigma_rad = 0.5 * std::numbers::pi / 180;
  return MakeSyntheticProblem(options, random);
}

void BM_Refine(benchmark::State& state) {
  const SyntheticProblem made = Make(static_cast<int>(state.range(0)));
  RefineOptions options;
  options.mode = static_cast<Refinement>(state.range(1));
  Rigid3 start = made.camera_from_map;
  start.translation += Eigen::Vector3d(0.01, -0.01, 0.01);
  for (auto _ : state) benchmark::DoNotOptimize(RefinePose(made.problem, start, options));
  state.SetLabel(std::string(RefinementName(options.mode)));
}
BENCHMARK(BM_Refine)
    ->Args({10, static_cast<int>(Refinement::kAuto)})
    ->Args({100, static_cast<int>(Refinement::kAuto)})
    ->Args({100, static_cast<int>(Refinement::k4Dof)})
    ->Args({100, static_cast<int>(Refinement::k6Dof)})
    ->Unit(benchmark::kMicrosecond);

void BM_Confidence(benchmark::State& state) {
  const SyntheticProblem made = Make(static_cast<int>(state.range(0)));
  const RefinedPose pose = RefinePose(made.problem, made.camera_from_map, {});
  for (auto _ : state) benchmark::DoNotOptimize(PoseConfidence(made.problem, pose, {}));
}
BENCHMARK(BM_Confidence)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace maploc::testing
