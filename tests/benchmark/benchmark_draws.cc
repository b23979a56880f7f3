// What the selector takes for granted about RANSAC (mapstore/statistics/MEASUREMENTS.md): the share
// of draws that are evaluated, all-inlier ones and others, and what an iteration of each strategy
// costs beside the others'.
#include <numbers>
#include <vector>

#include <benchmark/benchmark.h>

#include "server/ransac/prepared_problem.h"
#include "server/ransac/sampler.h"
#include "server/ransac/search.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kGravityNoiseRad = 0.5 * std::numbers::pi / 180.0;
constexpr int kProblems = 20;
constexpr int kDrawsOfProblem = 500;

enum Kind { kTwoPoints, kPointAndLine, kPointAndVerticals };

SyntheticOptions HalfWrong(Kind kind, Scene scene, bool outliers) {
  SyntheticOptions options;
  options.scene = scene;
  options.point_inliers = 100;
  options.point_outliers = outliers ? 100 : 0;
  options.line_inliers = kind == kTwoPoints ? 0 : 40;
  options.line_outliers = kind == kTwoPoints || !outliers ? 0 : 40;
  options.vertical_line_share = kind == kPointAndVerticals ? 1.0 : 0.0;
  options.gravity_noise_rad = options.gravity_sigma_rad = kGravityNoiseRad;
  return options;
}

double EvaluatedShare(const SyntheticOptions& options, Strategy strategy, int repetition) {
  Random random(static_cast<std::uint64_t>(repetition) + 1);
  int evaluated = 0;
  for (int i = 0; i < kProblems; ++i) {
    const SyntheticProblem made = MakeSyntheticProblem(options, random);
    const PreparedProblem prepared = PrepareProblem(made.problem, random);
    Sampler sampler(prepared, strategy);
    for (int draw = 0; draw < kDrawsOfProblem; ++draw) {
      evaluated += sampler.Draw(random).count > 0 ? 1 : 0;
    }
  }
  return static_cast<double>(evaluated) / (kProblems * kDrawsOfProblem);
}

// Of all draws with half of the features wrong, those that are all inliers.
double GoodShare(Kind kind) {
  if (kind == kTwoPoints) return 0.5 * 99.0 / 199.0;
  return kind == kPointAndLine ? 0.5 * 0.5 : 0.5 * 0.5 * 39.0 / 79.0;
}

void BM_DrawsEvaluated(benchmark::State& state) {
  const Kind kind = static_cast<Kind>(state.range(0));
  const Scene scene = state.range(1) == 0 ? Scene::kCube : Scene::kCorridor;
  const Strategy strategy = kind == kTwoPoints ? Strategy::k2P : Strategy::k1P1L;
  double good = 0.0;
  double all = 0.0;
  int repetitions = 0;
  for (auto _ : state) {
    good += EvaluatedShare(HalfWrong(kind, scene, false), strategy, repetitions);
    all += EvaluatedShare(HalfWrong(kind, scene, true), strategy, repetitions);
    ++repetitions;
  }
  good /= repetitions;
  all /= repetitions;
  state.counters["good"] = good;
  state.counters["bad"] = (all - GoodShare(kind) * good) / (1.0 - GoodShare(kind));
}
BENCHMARK(BM_DrawsEvaluated)
    ->ArgNames({"kind", "corridor"})
    ->ArgsProduct({{kTwoPoints, kPointAndLine, kPointAndVerticals}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

// A fixed number of iterations, so that time / iterations is what one costs.
void BM_Iteration(benchmark::State& state) {
  const Strategy strategy = static_cast<Strategy>(state.range(0));
  const int points = static_cast<int>(state.range(1));
  SyntheticOptions options;
  options.scene = state.range(4) == 0 ? Scene::kCube : Scene::kCorridor;
  options.point_inliers = points * static_cast<int>(state.range(2)) / 100;
  options.point_outliers = points - options.point_inliers;
  options.line_inliers = points / 5 * 3 / 10;
  options.line_outliers = points / 5 - options.line_inliers;
  options.vertical_line_share = static_cast<double>(state.range(3)) / 100.0;
  options.gravity_noise_rad = options.gravity_sigma_rad = kGravityNoiseRad;
  Random random(7);
  std::vector<PreparedProblem> problems;
  for (int i = 0; i < kProblems; ++i) {
    problems.push_back(PrepareProblem(MakeSyntheticProblem(options, random).problem, random));
  }
  RansacOptions ransac;
  ransac.strategy = strategy;
  ransac.max_reprojection_error_px = 3.0;
  ransac.min_iterations = ransac.max_iterations = 1000;
  std::int64_t iterations = 0;
  std::size_t next = 0;
  for (auto _ : state) {
    iterations += SearchConsensus(problems[next], ransac, strategy, random).iterations;
    next = (next + 1) % problems.size();
  }
  state.SetItemsProcessed(iterations);
}
BENCHMARK(BM_Iteration)
    ->ArgNames({"strategy", "points", "right", "vertical", "corridor"})
    ->ArgsProduct({{1, 2, 3}, {100, 300, 1000}, {5, 30}, {30, 90}, {0, 1}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace maploc::testing
