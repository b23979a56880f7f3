// Points and lines a second of the scoring kernels (1.67G/s is 0.6 ns each), on AVX2 and on the
// widest target that is here.
#include <string>
#include <utility>

#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include "server/ransac/prepared_problem.h"
#include "tests/support/seen_through.h"

namespace maploc::testing {
namespace {

constexpr ScoringOptions kOptions = {0.008f, 0.01f};

// `frames`: through a fisheye.
PreparedProblem Make(int points, int lines, bool frames, ScoringPose* pose) {
  Random random(1);
  SyntheticOptions options;
  options.point_inliers = points / 2;
  options.point_outliers = points - points / 2;
  options.line_inliers = lines / 2;
  options.line_outliers = lines - lines / 2;
  SyntheticProblem made = MakeSyntheticProblem(options, random);
  if (frames) made = ThroughFisheye(std::move(made));
  PreparedProblem prepared = PrepareProblem(made.problem, random);
  PoseMatrix truth(made.camera_from_map);
  truth.translation += truth.rotation * prepared.centroid;
  *pose = ToScoringPose(truth);
  return prepared;
}

// Kernels dispatch among `targets` while this lives; 0: among all that the machine has.
class WithTargets {
 public:
  explicit WithTargets(std::int64_t targets) { hwy::SetSupportedTargetsForTest(targets); }
  ~WithTargets() { hwy::SetSupportedTargetsForTest(0); }
  WithTargets(const WithTargets&) = delete;
  WithTargets& operator=(const WithTargets&) = delete;
};

void Label(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetLabel(std::string(state.range(1) == 0 ? "widest" : hwy::TargetName(state.range(1))) +
                 (state.range(2) != 0 ? ", fisheye" : ""));
}

void BM_ScorePoints(benchmark::State& state) {
  const WithTargets targets(state.range(1));
  ScoringPose pose;
  const PreparedProblem prepared =
      Make(static_cast<int>(state.range(0)), 0, state.range(2) != 0, &pose);
  const std::size_t size = prepared.point_arrays.x.size();
  for (auto _ : state) {
    benchmark::DoNotOptimize(ScorePoints(prepared.point_arrays, 0, size, pose, kOptions));
  }
  Label(state);
}
BENCHMARK(BM_ScorePoints)->ArgsProduct({{64, 1000, 3000}, {HWY_AVX2, 0}, {0, 1}});

void BM_ScoreLines(benchmark::State& state) {
  const WithTargets targets(state.range(1));
  ScoringPose pose;
  const PreparedProblem prepared =
      Make(0, static_cast<int>(state.range(0)), state.range(2) != 0, &pose);
  const std::size_t size = prepared.line_arrays.x.size();
  for (auto _ : state) {
    benchmark::DoNotOptimize(ScoreLines(prepared.line_arrays, 0, size, pose, kOptions));
  }
  Label(state);
}
BENCHMARK(BM_ScoreLines)->ArgsProduct({{64, 300}, {HWY_AVX2, 0}, {0, 1}});

}  // namespace
}  // namespace maploc::testing
