// Simulated worlds with a known answer through the whole estimator: RANSAC and refinement.
#include <numbers>

#include <gtest/gtest.h>

#include "server/ransac/estimator.h"
#include "server/refinement/refine.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Trial {
  int found = 0;
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
    ++result.found;
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

TEST(Recovery, PrintsRobustness) {
  for (const double gravity : {0.0, 1.0}) {
    for (const int inliers : {10, 5, 4, 3}) {
      for (const Strategy strategy : {Strategy::kMixed, Strategy::k2P, Strategy::k1P1L}) {
        const Trial t = RunTrials(PaperProtocol(inliers, 0.8, gravity), strategy, 500, 100);
        printf("gravity %.0f inliers %d %s: %.3f (found %d)\n", gravity, inliers,
               std::string(StrategyName(strategy)).c_str(), t.success(), t.found);
      }
    }
  }
}

}  // namespace
}  // namespace maploc::testing
