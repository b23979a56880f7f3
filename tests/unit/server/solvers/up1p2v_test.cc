#include "server/solvers/up1p2v.h"

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/unit/server/solvers/upright_scene.h"

namespace maploc::testing {
namespace {

struct PointAndVerticals {
  Eigen::Vector3d ray, point;
  Eigen::Vector3d normal1, line1, normal2, line2;
};

// In the aligned frame of a scene whose camera is aligned itself.
PointAndVerticals MakeSample(const AlignedPose& truth, Random& random) {
  const auto visible_point = [&] {
    return Eigen::Vector3d(random.Uniform(2, 10), random.Uniform(-4, 4), random.Uniform(-2, 2));
  };
  const auto to_map = [&](const Eigen::Vector3d& in_aligned) {
    const Yaw back = {truth.yaw.cosine, -truth.yaw.sine};
    return TurnByYaw(back, in_aligned - truth.translation);
  };
  PointAndVerticals made;
  const Eigen::Vector3d p = visible_point();
  made.ray = p / p.x();
  made.point = to_map(p);
  const Eigen::Vector3d up(0, 0, 1);
  const Eigen::Vector3d l1 = visible_point();
  const Eigen::Vector3d l2 = visible_point();
  made.normal1 = l1.cross(l1 + up).normalized();
  made.normal2 = l2.cross(l2 + up).normalized();
  made.line1 = to_map(l1);
  made.line2 = to_map(l2);
  return made;
}

AlignedPose RandomAlignedPose(Random& random) {
  const double yaw = random.Uniform(-std::numbers::pi, std::numbers::pi);
  return {{std::cos(yaw), std::sin(yaw)}, RandomDirection(random)};
}

double YawError(const Yaw& a, const Yaw& b) {
  return std::abs(
      std::atan2(a.sine * b.cosine - a.cosine * b.sine, a.cosine * b.cosine + a.sine * b.sine));
}

TEST(Up1p2v, RecoversRandomPosesWithOneSolution) {
  Random random = TestRandom();
  std::vector<double> errors;
  for (int i = 0; i < 20000; ++i) {
    const AlignedPose truth = RandomAlignedPose(random);
    const PointAndVerticals s = MakeSample(truth, random);
    AlignedPose poses[2];
    const int count = SolveUp1p2v(s.ray, s.point, s.normal1, s.line1, s.normal2, s.line2, poses);
    ASSERT_EQ(count, 1) << "problem " << i;
    errors.push_back(YawError(poses[0].yaw, truth.yaw));
  }
  EXPECT_LT(Percentile(errors, 0.5), 1e-14);
  EXPECT_LT(Percentile(errors, 0.999), 1e-9);
}

TEST(Up1p2v, ConditioningIsZeroOnTheDangerCircle) {
  // Plan: the camera and the three landmarks on one circle.
  const double radius = 5;
  const auto on_circle = [&](double angle, double height) {
    return Eigen::Vector3d(radius * std::cos(angle) + radius, radius * std::sin(angle), height);
  };
  const Eigen::Vector3d p = on_circle(0.3, 1);
  const Eigen::Vector3d l1 = on_circle(1.2, 0);
  const Eigen::Vector3d l2 = on_circle(-1.0, 0);
  const Eigen::Vector3d up(0, 0, 1);
  EXPECT_NEAR(Up1p2vConditioning(p, p, l1.cross(up), l1, l2.cross(up), l2), 0, 1e-12);
  const Eigen::Vector3d away = l2 + Eigen::Vector3d(2, -2, 0);
  EXPECT_GT(Up1p2vConditioning(p, p, l1.cross(up), l1, away.cross(up), away), 0.05);
}

TEST(Up1p2v, APointOnBothImageLinesHasNoDepth) {
  const Eigen::Vector3d ray(1, 0, 0.2);
  const Eigen::Vector3d normal(0, 1, 0);
  AlignedPose poses[2];
  EXPECT_EQ(SolveUp1p2v(ray, {3, 0, 1}, normal, {5, 0, 0}, normal, {7, 0, 0}, poses), 0);
}

}  // namespace
}  // namespace maploc::testing
