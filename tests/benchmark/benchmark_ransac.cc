// Time to a pose and share of right answers by inlier rate, beside OpenCV's USAC_MAGSAC in the same
// run on the same problems: 1 px of noise, gravity to half a degree, confidence 0.999, at most
// 100,000 iterations. Right: within 1 degree and 0.25 m.
#include <chrono>
#include <map>
#include <numbers>

#include <benchmark/benchmark.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "server/ransac/estimator.h"
#include "server/refinement/refine.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kProblems = 50;
constexpr double kThresholdPx = 3.0;
constexpr int kMaxIterations = 100000;

struct Setting {
  int points = 0;
  int inlier_permille = 0;
  int lines = 0;  // at 30% inliers, 90% of them vertical
  auto operator<=>(const Setting&) const = default;
};

const std::vector<SyntheticProblem>& Problems(const Setting& setting) {
  static std::map<Setting, std::vector<SyntheticProblem>> all;
  std::vector<SyntheticProblem>& problems = all[setting];
  if (!problems.empty()) return problems;
  Random random(1);
  SyntheticOptions options;
  options.point_inliers = setting.points * setting.inlier_permille / 1000;
  options.point_outliers = setting.points - options.point_inliers;
  options.line_inliers = setting.lines * 3 / 10;
  options.line_outliers = setting.lines - options.line_inliers;
  options.vertical_line_share = 0.9;
  options.gravity_noise_rad = options.gravity_sigma_rad = 0.5 * kDegree;
  for (int i = 0; i < kProblems; ++i) problems.push_back(MakeSyntheticProblem(options, random));
  return problems;
}

bool IsRight(const Rigid3& camera_from_map, const SyntheticProblem& made) {
  const PoseError error = ComparePoses(camera_from_map, made.camera_from_map);
  return error.rotation_rad < 1.0 * kDegree && error.position < 0.25;
}

Rigid3 SolveOurs(const PoseProblem& problem, Strategy strategy, std::uint64_t seed) {
  RansacOptions options;
  options.strategy = strategy;
  options.fall_back = false;
  options.max_reprojection_error_px = kThresholdPx;
  options.max_iterations = kMaxIterations;
  options.seed = seed;
  return EstimateConsensus(problem, options).camera_from_map;
}

// Points alone: OpenCV knows no lines.
struct CvProblem {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
};

CvProblem ToCv(const PoseProblem& problem) {
  CvProblem cv_problem;
  for (const PointCorrespondence& point : problem.points) {
    const Eigen::Vector3d& p = point.position_in_map;
    const Eigen::Vector2d pixel = point.normalized * problem.focal_length_px;
    cv_problem.points.emplace_back(p.x(), p.y(), p.z());
    cv_problem.pixels.emplace_back(pixel.x(), pixel.y());
  }
  return cv_problem;
}

Rigid3 SolveMagsac(const CvProblem& problem, double focal) {
  const cv::Matx33d camera(focal, 0, 0, 0, focal, 0, 0, 0, 1);
  cv::Mat rotation, translation, inliers;
  try {
    if (!cv::solvePnPRansac(problem.points, problem.pixels, camera, cv::noArray(), rotation,
                            translation, false, kMaxIterations, kThresholdPx, 0.999, inliers,
                            cv::USAC_MAGSAC)) {
      return {};
    }
  } catch (const cv::Exception&) {
    return {};  // it throws where it finds nothing
  }
  cv::Vec3d w(rotation), t(translation);
  const Eigen::Vector3d turn(w[0], w[1], w[2]);
  Rigid3 pose;
  if (turn.norm() > 0) pose.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized());
  pose.translation = {t[0], t[1], t[2]};
  return pose;
}

template <typename Solve>
void Run(benchmark::State& state, const Setting& setting, const Solve& solve) {
  const std::vector<SyntheticProblem>& problems = Problems(setting);
  std::int64_t right = 0;
  std::size_t i = 0;
  for (auto _ : state) {
    const SyntheticProblem& made = problems[i % problems.size()];
    right += IsRight(solve(made, i), made) ? 1 : 0;
    ++i;
  }
  state.counters["right"] = static_cast<double>(right) / static_cast<double>(state.iterations());
}

Setting ToSetting(const benchmark::State& state) {
  return {static_cast<int>(state.range(0)), static_cast<int>(state.range(1)),
          static_cast<int>(state.range(2))};
}

void BM_Ransac(benchmark::State& state) {
  const Strategy strategy = static_cast<Strategy>(state.range(3));
  Run(state, ToSetting(state), [&](const SyntheticProblem& made, std::size_t i) {
    return SolveOurs(made.problem, strategy, i + 1);
  });
  state.SetLabel(std::string(StrategyName(strategy)));
}
BENCHMARK(BM_Ransac)
    ->ArgNames({"points", "permille", "lines", "strategy"})
    ->ArgsProduct({{1000}, {500, 100, 50, 20}, {0}, {static_cast<int>(Strategy::k2P)}})
    ->ArgsProduct({{1000}, {20}, {300}, {1, 2, 3}})
    ->Unit(benchmark::kMicrosecond);

void BM_OpenCvMagsac(benchmark::State& state) {
  std::vector<CvProblem> cv_problems;
  for (const SyntheticProblem& made : Problems(ToSetting(state))) {
    cv_problems.push_back(ToCv(made.problem));
  }
  Run(state, ToSetting(state), [&](const SyntheticProblem& made, std::size_t i) {
    return SolveMagsac(cv_problems[i % cv_problems.size()], made.problem.focal_length_px);
  });
}
BENCHMARK(BM_OpenCvMagsac)
    ->ArgNames({"points", "permille", "lines"})
    ->ArgsProduct({{1000}, {500, 100, 50, 20}, {0}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace maploc::testing
