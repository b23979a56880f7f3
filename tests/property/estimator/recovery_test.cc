// Simulated worlds with a known answer through the whole estimator: RANSAC and refinement.
#include <cmath>
#include <numbers>
#include <ostream>

#include <gtest/gtest.h>

#include "server/ransac/estimator.h"
#include "server/refinement/refine.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Trial {
  int right = 0;  // within 1 degree and 0.15 m of a camera 3 to 5 metres away
  int trials = 0;
  double success() const { return static_cast<double>(right) / trials; }
};

Trial RunTrials(const SyntheticOptions& synthetic, Strategy strategy, int trials,
                int max_iterations) {
  Trial result;
  Random random = TestRandom();
  for (int i = 0; i < trials; ++i) {
    const SyntheticProblem made = MakeSyntheticProblem(synthetic, random);
    RansacOptions options;
    options.strategy = strategy;
    options.max_reprojection_error_px = 3.0;
    options.max_iterations = max_iterations;
    options.min_iterations = std::min(20, max_iterations);
    options.fall_back = false;
    options.seed = random.Next();
    const Consensus consensus = EstimateConsensus(made.problem, options);
    ++result.trials;
    if (!consensus.found) continue;
    RefineOptions refine;
    refine.max_reprojection_error_px = 3.0;
    const RefinedPose pose = RefinePose(made.problem, consensus.camera_from_map, refine);
    const PoseError error = ComparePoses(pose.camera_from_map, made.camera_from_map);
    result.right += error.rotation_rad < 1.5 * kDegree && error.position < 0.15 ? 1 : 0;
  }
  return result;
}

SyntheticOptions PaperProtocol(int inliers, double outlier_rate, double gravity_noise_deg) {
  SyntheticOptions options;
  const int outliers = static_cast<int>(inliers * outlier_rate / (1.0 - outlier_rate) + 0.5);
  options.point_inliers = inliers;
  options.point_outliers = outliers;
  options.line_inliers = inliers;
  options.line_outliers = outliers;
  options.gravity_noise_rad = gravity_noise_deg * kDegree;
  options.gravity_sigma_rad = gravity_noise_deg * kDegree;
  return options;
}

// The paper's hardest column: 80% outliers, 1 px, 100 iterations. The bars are those of issue 3,
// less three standard deviations of 300 trials.
struct Cell {
  int inliers;
  double gravity_noise_deg;
  Strategy strategy;
  double success;
};

void PrintTo(const Cell& cell, std::ostream* out) {
  *out << StrategyName(cell.strategy) << " " << cell.inliers << " inliers, gravity noise "
       << cell.gravity_noise_deg;
}

class Robustness : public ::testing::TestWithParam<Cell> {};

TEST_P(Robustness, AtEightyPercentOutliers) {
  const Cell& cell = GetParam();
  constexpr int kTrials = 300;
  const Trial trial = RunTrials(PaperProtocol(cell.inliers, 0.8, cell.gravity_noise_deg),
                                cell.strategy, kTrials, 100);
  const double sigma = std::sqrt(cell.success * (1 - cell.success) / kTrials);
  EXPECT_GE(trial.success(), cell.success - 3 * sigma);
}

INSTANTIATE_TEST_SUITE_P(
    Paper, Robustness,
    ::testing::Values(Cell{10, 0, Strategy::kMixed, .99}, Cell{5, 0, Strategy::kMixed, .98},
                      Cell{4, 0, Strategy::kMixed, .97}, Cell{3, 0, Strategy::kMixed, .95},
                      Cell{10, 0, Strategy::k2P, .99}, Cell{5, 0, Strategy::k2P, .95},
                      Cell{4, 0, Strategy::k2P, .91}, Cell{3, 0, Strategy::k2P, .75},
                      Cell{10, 0, Strategy::k1P1L, .98}, Cell{5, 0, Strategy::k1P1L, .95},
                      Cell{4, 0, Strategy::k1P1L, .93}, Cell{3, 0, Strategy::k1P1L, .90},
                      Cell{10, 1, Strategy::kMixed, .97}, Cell{5, 1, Strategy::kMixed, .92},
                      Cell{4, 1, Strategy::kMixed, .89}, Cell{3, 1, Strategy::kMixed, .80}));

}  // namespace
}  // namespace maploc::testing
