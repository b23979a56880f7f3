// ns a point and a line of the scoring kernels.
#include <benchmark/benchmark.h>

#include "server/ransac/prepared_problem.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr ScoringOptions kOptions = {0.008f, 0.01f};

PreparedProblem Make(int points, int lines, ScoringPose* pose) {
  Random random(1);
  SyntheticOptions options;
  options.point_inliers = points / 2;
  options.point_outliers = points - points / 2;
  options.line_inliers = lines / 2;
  options.line_outliers = lines - lines / 2;
  const SyntheticProblem made = MakeSyntheticProblem(options, random);
  PreparedProblem prepared = PrepareProblem(made.problem, random);
  PoseMatrix truth(made.camera_from_map);
  truth.translation += truth.rotation * prepared.centroid;
  *pose = ToScoringPose(truth);
  return prepared;
}

void BM_ScorePoints(benchmark::State& state) {
  ScoringPose pose;
  const PreparedProblem prepared = Make(static_cast<int>(state.range(0)), 0, &pose);
  const std::size_t size = prepared.point_arrays.x.size();
  for (auto _ : state) {
    benchmark::DoNotOptimize(ScorePoints(prepared.point_arrays, 0, size, pose, kOptions));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_ScorePoints)->Arg(64)->Arg(1000)->Arg(3000);

void BM_ScoreLines(benchmark::State& state) {
  ScoringPose pose;
  const PreparedProblem prepared = Make(0, static_cast<int>(state.range(0)), &pose);
  const std::size_t size = prepared.line_arrays.x.size();
  for (auto _ : state) {
    benchmark::DoNotOptimize(ScoreLines(prepared.line_arrays, 0, size, pose, kOptions));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_ScoreLines)->Arg(64)->Arg(300);

}  // namespace
}  // namespace maploc::testing
