#include "server/solvers/up1p2v.h"

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/unit/server/solvers/recovery.h"
#include "tests/unit/server/solvers/upright_scene.h"

namespace maploc::testing {
namespace {

struct PointAndVerticals {
  Eigen::Vector3d ray, point;
  Eigen::Vector3d normal1, line1, normal2, line2;
};

Eigen::Vector3d ToMap(const AlignedPose& truth, const Eigen::Vector3d& in_aligned) {
  const Yaw back = {truth.yaw.cosine, -truth.yaw.sine};
  return TurnByYaw(back, in_aligned - truth.translation);
}

// From places in the aligned frame: the point, and one on each vertical.
PointAndVerticals MakeSample(const AlignedPose& truth, const Eigen::Vector3d& p,
                             const Eigen::Vector3d& l1, const Eigen::Vector3d& l2) {
  const Eigen::Vector3d up(0, 0, 1);
  return {p,
          ToMap(truth, p),
          l1.cross(up).normalized(),
          ToMap(truth, l1),
          l2.cross(up).normalized(),
          ToMap(truth, l2)};
}

PointAndVerticals MakeSample(const AlignedPose& truth, Random& random, double scale = 1.0) {
  const auto visible_point = [&]() -> Eigen::Vector3d {
    return scale *
           Eigen::Vector3d(random.Uniform(2, 10), random.Uniform(-4, 4), random.Uniform(-2, 2));
  };
  const Eigen::Vector3d p = visible_point();
  const Eigen::Vector3d l1 = visible_point();
  return MakeSample(truth, p, l1, visible_point());
}

AlignedPose RandomAlignedPose(Random& random) {
  const double yaw = random.Uniform(-std::numbers::pi, std::numbers::pi);
  return {{std::cos(yaw), std::sin(yaw)}, RandomDirection(random)};
}

double YawError(const Yaw& a, const Yaw& b) {
  return std::abs(
      std::atan2(a.sine * b.cosine - a.cosine * b.sine, a.cosine * b.cosine + a.sine * b.sine));
}

// The yaw's error; pi unless there is exactly one solution. The position's is not looked at.
PoseError SolvedError(const PointAndVerticals& s, const AlignedPose& truth) {
  AlignedPose poses[2];
  const int count = SolveUp1p2v(s.ray, s.point, s.normal1, s.line1, s.normal2, s.line2, poses);
  return {.rotation_rad = count == 1 ? YawError(poses[0].yaw, truth.yaw) : std::numbers::pi};
}

TEST(Up1p2v, RecoversRandomPosesWithOneSolution) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random = TestRandom(seed);
    const Errors errors = ErrorsOver(kManyProblems, [&](int) {
      const AlignedPose truth = RandomAlignedPose(random);
      return SolvedError(MakeSample(truth, random), truth);
    });
    const ErrorSummary summary = ExpectRecovered(errors, {.percent999_rad = 1e-11});
    EXPECT_LT(summary.median, 1e-14);
  }
}

TEST(Up1p2v, NoYawIsSpecial) {
  Random random = TestRandom();
  const Yaw yaws[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  for (const Yaw& yaw : yaws) {
    const Errors errors = ErrorsOver(5000, [&](int) {
      const AlignedPose truth = {yaw, RandomDirection(random)};
      return SolvedError(MakeSample(truth, random), truth);
    });
    ExpectRecovered(errors, {.percent99_rad = 1e-11});
  }
}

// All at the camera's height: to verticals and a bearing, heights are nothing.
TEST(Up1p2v, EqualHeightsAreNotDegenerate) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(5000, [&](int) {
    const AlignedPose truth = RandomAlignedPose(random);
    const auto level = [&] {
      return Eigen::Vector3d(random.Uniform(2, 10), random.Uniform(-4, 4), 0);
    };
    const Eigen::Vector3d p = level();
    const Eigen::Vector3d l1 = level();
    return SolvedError(MakeSample(truth, p, l1, level()), truth);
  });
  ExpectRecovered(errors, {.percent99_rad = 1e-11});
}

TEST(Up1p2v, RaysOneDegreeApart) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(20000, [&](int) {
    const AlignedPose truth = RandomAlignedPose(random);
    const double bearing = random.Uniform(-1, 1);
    const auto at = [&](double degrees) -> Eigen::Vector3d {
      const double angle = bearing + degrees * kDegree;
      return random.Uniform(2, 10) *
             Eigen::Vector3d(std::cos(angle), std::sin(angle), random.Uniform(-0.3, 0.3));
    };
    const Eigen::Vector3d p = at(0);
    const Eigen::Vector3d l1 = at(1);
    return SolvedError(MakeSample(truth, p, l1, at(-1)), truth);
  });
  ExpectRecovered(errors, {.percent99_rad = 1e-11});
}

TEST(Up1p2v, MapFiveHundredKilometresFromItsOrigin) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(20000, [&](int) {
    const AlignedPose truth = RandomAlignedPose(random);
    PointAndVerticals s = MakeSample(truth, random);
    for (Eigen::Vector3d* position : {&s.point, &s.line1, &s.line2}) *position += kFarAway;
    // Seen where they are stored: an exact difference.
    const auto ray_to = [&](const Eigen::Vector3d& position) {
      return truth * (position - kFarAway);
    };
    const Eigen::Vector3d up(0, 0, 1);
    s.ray = ray_to(s.point);
    s.normal1 = ray_to(s.line1).cross(up);
    s.normal2 = ray_to(s.line2).cross(up);
    return SolvedError(s, truth);
  });
  ExpectRecovered(errors, {.percent999_rad = 1e-11});
}

TEST(Up1p2v, ScenesOfCentimetres) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(20000, [&](int) {
    AlignedPose truth = RandomAlignedPose(random);
    truth.translation *= 0.01;
    return SolvedError(MakeSample(truth, random, 0.01), truth);
  });
  ExpectRecovered(errors, {.percent999_rad = 1e-11});
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
