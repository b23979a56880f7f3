// Refinement and confidence of a pose: points and half as many lines, gravity to half a degree.
#include <numbers>
#include <string>
#include <utility>

#include <benchmark/benchmark.h>

#include "server/refinement/refine.h"
#include "server/trust/confidence.h"
#include "tests/support/seen_through.h"

namespace maploc::testing {
namespace {

SyntheticProblem Make(int points, bool fisheye = false) {
  Random random(1);
  SyntheticOptions options;
  options.point_inliers = points;
  options.point_outliers = points;
  options.line_inliers = points / 2;
  options.line_outliers = points / 2;
  options.gravity_noise_rad = options.gravity_sigma_rad = 0.5 * std::numbers::pi / 180;
  SyntheticProblem made = MakeSyntheticProblem(options, random);
  return fisheye ? ThroughFisheye(std::move(made)) : made;
}

void BM_Refine(benchmark::State& state) {
  const bool fisheye = state.range(2) != 0;
  const SyntheticProblem made = Make(static_cast<int>(state.range(0)), fisheye);
  RefineOptions options;
  options.mode = static_cast<Refinement>(state.range(1));
  Rigid3 start = made.camera_from_map;
  start.translation += Eigen::Vector3d(0.01, -0.01, 0.01);
  for (auto _ : state) benchmark::DoNotOptimize(RefinePose(made.problem, start, options));
  state.SetLabel(std::string(RefinementName(options.mode)) + (fisheye ? ", fisheye" : ""));
}
BENCHMARK(BM_Refine)
    ->Args({10, static_cast<int>(Refinement::kAuto), 0})
    ->Args({100, static_cast<int>(Refinement::kAuto), 0})
    ->Args({100, static_cast<int>(Refinement::kAuto), 1})
    ->Args({100, static_cast<int>(Refinement::k4Dof), 0})
    ->Args({100, static_cast<int>(Refinement::k6Dof), 0})
    ->Unit(benchmark::kMicrosecond);

void BM_Confidence(benchmark::State& state) {
  const bool fisheye = state.range(1) != 0;
  const SyntheticProblem made = Make(static_cast<int>(state.range(0)), fisheye);
  const RefinedPose pose = RefinePose(made.problem, made.camera_from_map, {});
  for (auto _ : state) benchmark::DoNotOptimize(PoseConfidence(made.problem, pose, {}));
  state.SetLabel(fisheye ? "fisheye" : "pinhole");
}
BENCHMARK(BM_Confidence)->ArgsProduct({{10, 100, 1000}, {0, 1}})->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace maploc::testing
