#include "server/refinement/pose_residuals.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "mapstore/geometry/gravity.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

InlierFlags All(const PoseProblem& problem) {
  InlierFlags flags;
  flags.points.assign(problem.points.size(), 1);
  flags.lines.assign(problem.lines.size(), 1);
  return flags;
}

Eigen::VectorXd Values(const PoseResiduals& residuals, const Eigen::VectorXd& parameters) {
  Eigen::VectorXd values(residuals.count());
  residuals.Evaluate(parameters.data(), values.data(), nullptr);
  return values;
}

// Largest difference between the Jacobian and central differences of the residuals, relative.
double JacobianError(const PoseResiduals& residuals, const Eigen::VectorXd& parameters) {
  constexpr double kStep = 1e-6;
  Eigen::VectorXd values(residuals.count());
  Eigen::MatrixXd analytic(residuals.count(), parameters.size());
  residuals.Evaluate(parameters.data(), values.data(), analytic.data());
  EXPECT_EQ(values, Values(residuals, parameters));
  double worst = 0;
  for (int k = 0; k < parameters.size(); ++k) {
    Eigen::VectorXd high = parameters;
    Eigen::VectorXd low = parameters;
    high(k) += kStep;
    low(k) -= kStep;
    const Eigen::VectorXd numeric =
        (Values(residuals, high) - Values(residuals, low)) / (2 * kStep);
    const Eigen::ArrayXd difference = (numeric - analytic.col(k)).array().abs();
    worst = std::max(worst, (difference / (1 + numeric.array().abs())).maxCoeff());
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
    const ResidualScales scales{.feature_sigma = 0.002, .gravity_sigma_rad = 0.01};
    const PoseResiduals residuals(made.problem, All(made.problem), chart, scales);
    ASSERT_EQ(residuals.count(), 14);
    Eigen::VectorXd parameters(chart.size() + 3);
    for (double& turn : parameters.head(chart.size())) {
      turn = i == 0 ? 0.0 : random.Uniform(-0.05, 0.05);  // from near misses to far beyond the loss
    }
    parameters.tail<3>() = made.camera_from_map.translation + Eigen::Vector3d(0.01, -0.02, 0.03);
    EXPECT_LT(JacobianError(residuals, parameters), 1e-5);
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

TEST(PoseResiduals, GravityIsTheAngleInSigmas) {
  PoseProblem problem;
  problem.gravity_in_camera = Eigen::Vector3d(0, 1, 0);
  const PoseResiduals residuals(problem, {},
                                FreeChart(CameraFromAligned(problem.gravity_in_camera)),
                                {.feature_sigma = 1, .gravity_sigma_rad = 0.01});
  ASSERT_EQ(residuals.count(), 2);
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(6);
  parameters(0) = 0.03;
  EXPECT_NEAR(Values(residuals, parameters).norm(), 3.0, 1e-3);
  parameters.head<3>() = Eigen::Vector3d(0, 1, 0);  // about gravity
  EXPECT_NEAR(Values(residuals, parameters).norm(), 0.0, 1e-9);
}

TEST(PoseResiduals, AreCauchysLoss) {
  PoseProblem problem;
  problem.points.emplace_back().position_in_map = {0, 0, 1};
  const PoseResiduals residuals(problem, All(problem), FreeChart(Eigen::Quaterniond::Identity()),
                                {.feature_sigma = 0.01, .loss_scale = 2.5});
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(6);
  for (const double sigmas : {0.0, 0.01, 1.0, 10.0}) {
    parameters(3) = 0.01 * sigmas;
    EXPECT_NEAR(Values(residuals, parameters).squaredNorm(),
                6.25 * std::log1p(sigmas * sigmas / 6.25), 1e-9);
  }
}

TEST(PoseResiduals, APointBehindTheCameraCostsMoreThanAnyInFront) {
  PoseProblem problem;
  problem.points.emplace_back().position_in_map = {0, 0, 1};
  const PoseResiduals residuals(problem, All(problem), FreeChart(Eigen::Quaterniond::Identity()),
                                {.feature_sigma = 0.002});
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(6);
  parameters(3) = 100;
  const double in_front = Values(residuals, parameters).norm();
  parameters(5) = -2;
  EXPECT_GT(Values(residuals, parameters).norm(), in_front);
}

}  // namespace
}  // namespace maploc::testing
