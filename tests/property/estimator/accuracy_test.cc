// Refinement with gravity as a measurement is as good as the better of holding it and forgetting
// it, wherever gravity's sigma is what is stated.
#include <algorithm>
#include <array>
#include <numbers>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>

#include "mapstore/base/median.h"
#include "server/refinement/refine.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kTrials = 2000;
constexpr std::array kModes = {Refinement::kAuto, Refinement::k4Dof, Refinement::k6Dof};

struct Cell {
  int matches;  // points, and as many lines
  double gravity_sigma_deg;
};

void PrintTo(const Cell& cell, std::ostream* out) {
  *out << cell.matches << " points and lines, gravity " << cell.gravity_sigma_deg << " degrees";
}

void ExpectAsGoodAsTheBetter(double of_auto, double held, double forgotten) {
  EXPECT_LE(of_auto, 1.05 * std::min(held, forgotten));
  if (std::max(held, forgotten) > 1.1 * std::min(held, forgotten)) {
    EXPECT_LT(of_auto, std::max(held, forgotten));
  }
}

class Accuracy : public ::testing::TestWithParam<Cell> {};

TEST_P(Accuracy, AutoIsAsGoodAsTheBetterMode) {
  Random random = TestRandom();
  SyntheticOptions synthetic;
  synthetic.point_inliers = synthetic.line_inliers = GetParam().matches;
  synthetic.gravity_noise_rad = GetParam().gravity_sigma_deg * kDegree;
  synthetic.gravity_sigma_rad = synthetic.gravity_noise_rad;
  std::array<std::vector<double>, 3> rotations;
  std::array<std::vector<double>, 3> positions;
  for (int i = 0; i < kTrials; ++i) {
    const SyntheticProblem made = MakeSyntheticProblem(synthetic, random);
    for (std::size_t k = 0; k < kModes.size(); ++k) {
      RefineOptions options;
      options.mode = kModes[k];
      const RefinedPose pose = RefinePose(made.problem, made.camera_from_map, options);
      const PoseError error = ComparePoses(pose.camera_from_map, made.camera_from_map);
      rotations[k].push_back(error.rotation_rad);
      positions[k].push_back(error.position);
    }
  }
  ExpectAsGoodAsTheBetter(Median(rotations[0]), Median(rotations[1]), Median(rotations[2]));
  ExpectAsGoodAsTheBetter(Median(positions[0]), Median(positions[1]), Median(positions[2]));
}

INSTANTIATE_TEST_SUITE_P(Cells, Accuracy,
                         ::testing::Values(Cell{10, 0}, Cell{5, 0}, Cell{4, 0}, Cell{3, 0},
                                           Cell{10, .5}, Cell{5, .5}, Cell{4, .5}, Cell{3, .5},
                                           Cell{10, 1}, Cell{5, 1}, Cell{4, 1}, Cell{3, 1},
                                           Cell{10, 2}, Cell{5, 2}, Cell{4, 2}, Cell{3, 2}));

}  // namespace
}  // namespace maploc::testing
