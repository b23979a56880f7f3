#include "server/refinement/cost_functions.h"

#include <gtest/gtest.h>

#include "mapstore/geometry/gravity.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

// Largest difference between the cost's Jacobian and central differences of its residuals,
// relative.
double JacobianError(const ceres::CostFunction& cost, std::vector<std::vector<double>> blocks) {
  const auto& sizes = cost.parameter_block_sizes();
  std::vector<const double*> pointers;
  for (const auto& block : blocks) pointers.push_back(block.data());
  std::vector<std::vector<double>> jacobians;
  std::vector<double*> jacobian_pointers;
  for (const int size : sizes) jacobians.emplace_back(2 * size);
  for (auto& jacobian : jacobians) jacobian_pointers.push_back(jacobian.data());
  double residuals[2];
  EXPECT_TRUE(cost.Evaluate(pointers.data(), residuals, jacobian_pointers.data()));
  double worst = 0;
  constexpr double kStep = 1e-6;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (int k = 0; k < sizes[b]; ++k) {
      double high[2], low[2];
      const double value = blocks[b][k];
      blocks[b][k] = value + kStep;
      EXPECT_TRUE(cost.Evaluate(pointers.data(), high, nullptr));
      blocks[b][k] = value - kStep;
      EXPECT_TRUE(cost.Evaluate(pointers.data(), low, nullptr));
      blocks[b][k] = value;
      for (int r = 0; r < 2; ++r) {
        const double numeric = (high[r] - low[r]) / (2 * kStep);
        const double analytic = jacobians[b][r * sizes[b] + k];
        worst = std::max(worst, std::abs(numeric - analytic) / (1 + std::abs(numeric)));
      }
    }
  }
  return worst;
}

class Charts : public ::testing::TestWithParam<bool> {
 protected:
  RotationChart Chart(const SyntheticProblem& made) const {
    return GetParam() ? FreeChart(made.camera_from_map.rotation)
                      : YawChart(made.camera_from_map.rotation, made.problem.gravity_in_camera);
  }
};

TEST_P(Charts, JacobiansAgreeWithDifferencesAwayFromTheBase) {
  Random random = TestRandom();
  SyntheticOptions options;
  options.point_inliers = 3;
  options.line_inliers = 3;
  options.gravity_noise_rad = 0.02;
  for (int i = 0; i < 100; ++i) {
    const SyntheticProblem made = MakeSyntheticProblem(options, random);
    const RotationChart chart = Chart(made);
    std::vector<double> turn(chart.size());
    for (double& value : turn) value = i == 0 ? 0.0 : random.Uniform(-0.05, 0.05);
    const Eigen::Vector3d& t = made.camera_from_map.translation;
    const std::vector<double> translation = {t.x() + 0.01, t.y() - 0.02, t.z() + 0.03};
    for (const auto& point : made.problem.points) {
      EXPECT_LT(JacobianError(*MakePointCost(chart, point, 0.002), {turn, translation}), 1e-6);
    }
    for (const auto& line : made.problem.lines) {
      EXPECT_LT(JacobianError(*MakeLineCost(chart, line, 0.002), {turn, translation}), 1e-5);
    }
    EXPECT_LT(JacobianError(*MakeGravityCost(chart, made.problem.gravity_in_camera, 0.01), {turn}),
              1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(FreeAndYaw, Charts, ::testing::Bool(),
                         [](const auto& param) { return param.param ? "Free" : "Yaw"; });

TEST(YawChart, KeepsGravityAtEveryTurn) {
  Random random = TestRandom();
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d gravity = RandomDirection(random);
    const RotationChart chart = YawChart(RandomRotation(random), gravity);
    const double turn = random.Uniform(-3, 3);
    EXPECT_LT((chart.Rotation(&turn) * kGravityInMap - gravity).norm(), 1e-12);
  }
}

TEST(GravityCost, IsTheAngleInSigmas) {
  const Eigen::Vector3d gravity(0, 1, 0);
  const RotationChart chart = FreeChart(CameraFromAligned(gravity));
  const double tilt[3] = {0.03, 0, 0};
  const double* parameters[] = {tilt};
  double residuals[2];
  ASSERT_TRUE(MakeGravityCost(chart, gravity, 0.01)->Evaluate(parameters, residuals, nullptr));
  EXPECT_NEAR(std::hypot(residuals[0], residuals[1]), 3.0, 1e-3);
  const double yaw[3] = {0, 1.0, 0};
  const double* about_gravity[] = {yaw};
  ASSERT_TRUE(MakeGravityCost(chart, gravity, 0.01)->Evaluate(about_gravity, residuals, nullptr));
  EXPECT_NEAR(std::hypot(residuals[0], residuals[1]), 0.0, 1e-9);
}

TEST(PointCost, RefusesAPointBehindTheCamera) {
  const RotationChart chart = FreeChart(Eigen::Quaterniond::Identity());
  PointCorrespondence point;
  point.position_in_map = {0, 0, 1};
  const double turn[3] = {0, 0, 0};
  const double translation[3] = {0, 0, -2};
  const double* parameters[] = {turn, translation};
  double residuals[2];
  EXPECT_FALSE(MakePointCost(chart, point, 1)->Evaluate(parameters, residuals, nullptr));
}

}  // namespace
}  // namespace maploc::testing
