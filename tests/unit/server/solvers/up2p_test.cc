#include "server/solvers/up2p.h"

#include <gtest/gtest.h>

#include "server/solvers/yaw_equation.h"
#include "tests/support/seed.h"
#include "tests/unit/server/solvers/paper_route.h"
#include "tests/unit/server/solvers/recovery.h"
#include "tests/unit/server/solvers/upright_scene.h"
#include "tests/unit/server/solvers/with_gravity.h"

namespace maploc::testing {
namespace {

struct PairOfPoints {
  Eigen::Vector3d ray1, point1, ray2, point2;
};

PairOfPoints MakePair(const UprightScene& scene, Random& random, double depth_scale = 1.0) {
  PairOfPoints pair;
  pair.ray1 = RandomRay(random);
  pair.ray2 = RandomRay(random);
  pair.point1 = scene.PointInMap(pair.ray1, depth_scale * random.Uniform(1, 10));
  pair.point2 = scene.PointInMap(pair.ray2, depth_scale * random.Uniform(1, 10));
  return pair;
}

int Solve(const UprightScene& scene, const PairOfPoints& pair, Rigid3 poses[2]) {
  return SolveUp2p(scene.gravity_in_camera, pair.ray1, pair.point1, pair.ray2, pair.point2, poses);
}

PoseError SolvedError(const UprightScene& scene, const PairOfPoints& pair) {
  Rigid3 poses[2];
  const int count = Solve(scene, pair, poses);
  return BestError(poses, count, scene.camera_from_map);
}

// Returns 0 or 2 (a double root twice); 0 where the yaw is unobservable.
int SolveYaw(const YawEquation& equation, Yaw yaws[2]) {
  const YawRoots roots = FindYawRoots(equation);
  if (!(roots.real && roots.r2 > 0)) return 0;
  const double inverse = 1.0 / roots.r2;
  yaws[0] = roots.Root(-1.0, inverse);
  yaws[1] = roots.Root(1.0, inverse);
  return 2;
}

TEST(Up2p, RecoversRandomPoses) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random = TestRandom(seed);
    const Errors errors = ErrorsOver(kManyProblems, [&](int) {
      const UprightScene scene = MakeScene(random, 3.0 * RandomDirection(random));
      return SolvedError(scene, MakePair(scene, random));
    });
    ExpectRecovered(errors, {.percent999_rad = 1e-11});
    EXPECT_LT(Percentile(errors.rotation_rad, kAllButFive), 1e-7);
    EXPECT_LT(Percentile(errors.position, kAllButFive), 1e-6);
    EXPECT_LT(Percentile(errors.position, 1.0), 1e-4);
  }
}

TEST(Up2p, EveryKeptPoseSeesBothPointsWhereTheyWereSeen) {
  Random random = TestRandom();
  for (int i = 0; i < 2000; ++i) {
    const UprightScene scene = MakeScene(random);
    PairOfPoints pair = MakePair(scene, random);
    pair.point2 += 0.3 * RandomDirection(random);  // no longer the truth, still a problem
    if (Up2pConditioning(pair.ray1, pair.point1, pair.ray2, pair.point2) < 0.05) continue;
    Rigid3 poses[2];
    const int count = Solve(scene, pair, poses);
    for (int k = 0; k < count; ++k) {
      const Eigen::Vector3d q1 = poses[k] * pair.point1;
      const Eigen::Vector3d q2 = poses[k] * pair.point2;
      EXPECT_GT(q1.z(), 0);
      EXPECT_GT(q2.z(), 0);
      EXPECT_LT((q1 / q1.z() - pair.ray1).norm(), 1e-6);
      EXPECT_LT((q2 / q2.z() - pair.ray2).norm(), 1e-6);
      EXPECT_LT(AngleBetween(GravityInCamera(poses[k].rotation), scene.gravity_in_camera), 1e-7);
    }
  }
}

TEST(Up2p, NoYawIsSpecial) {
  Random random = TestRandom();
  ExpectNoYawIsSpecial(random, [&](const UprightScene& scene) {
    return SolvedError(scene, MakePair(scene, random));
  });
}

TEST(Up2p, PairsOfEqualHeightAreNotDegenerate) {
  Random random = TestRandom();
  for (int i = 0; i < 2000; ++i) {
    const bool at_yaw_zero = i % 2 == 0;
    const UprightScene scene =
        at_yaw_zero ? MakeSceneWithYaw(1, 0, random) : MakeScene(random, RandomDirection(random));
    PairOfPoints pair;
    pair.ray1 = RandomRay(random);
    pair.point1 = scene.PointInMap(pair.ray1, random.Uniform(1, 10));
    Eigen::Vector3d in_camera;
    do {
      const double angle = random.Uniform(0, 2 * std::numbers::pi);
      pair.point2 = pair.point1 + 2.0 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
      in_camera = scene.camera_from_map * pair.point2;
    } while (in_camera.z() < 0.1);
    pair.ray2 = in_camera / in_camera.z();
    EXPECT_LT(SolvedError(scene, pair).rotation_rad, 1e-8) << "problem " << i;
  }
}

TEST(Up2p, RaysOneDegreeApart) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(20000, [&](int) {
    const UprightScene scene = MakeScene(random);
    PairOfPoints pair = MakePair(scene, random);
    const Eigen::Vector3d axis = pair.ray1.cross(RandomDirection(random)).normalized();
    pair.ray2 = Eigen::AngleAxisd(kDegree, axis) * pair.ray1;
    pair.point2 = scene.PointInMap(pair.ray2, random.Uniform(1, 10));
    return SolvedError(scene, pair);
  });
  // The rays' rounding against one degree, 60 times that of the others.
  ExpectRecovered(errors, {.percent99_rad = 1e-11});
  EXPECT_LT(Percentile(errors.rotation_rad, 0.9995), 1e-8);
}

TEST(Up2p, MapFiveHundredKilometresFromItsOrigin) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(20000, [&](int) {
    const UprightScene scene = MakeScene(random, kFarAway);
    PairOfPoints pair = MakePair(scene, random);
    pair.ray1 = scene.RayTo(pair.point1);
    pair.ray2 = scene.RayTo(pair.point2);
    return SolvedError(scene, pair);
  });
  ExpectRecovered(errors, {.percent999_rad = 1e-11});
  EXPECT_LE(Percentile(errors.position, 0.999), kFarPositionError);
}

TEST(Up2p, ScenesOfCentimetres) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(20000, [&](int) {
    const UprightScene scene = MakeScene(random, 0.01 * RandomDirection(random));
    return SolvedError(scene, MakePair(scene, random, 0.01));
  });
  ExpectRecovered(errors, {.percent999_rad = 1e-11});
  EXPECT_LT(Percentile(errors.position, 0.999), 1e-9);
  EXPECT_LT(Percentile(errors.position, 1.0), 1e-7);
}

TEST(Up2p, EqualRaysOrEqualPointsHaveNoSolution) {
  const Eigen::Vector3d gravity(0, 1, 0);
  const Eigen::Vector3d ray(0.1, 0.2, 1);
  const Eigen::Vector3d other(-0.3, 0.1, 1);
  const Eigen::Vector3d point(1, 2, 3);
  Rigid3 poses[2];
  EXPECT_EQ(SolveUp2p(gravity, ray, point, ray, Eigen::Vector3d(2, 2, 3), poses), 0);
  EXPECT_EQ(SolveUp2p(gravity, ray, point, other, point, poses), 0);
  EXPECT_EQ(Up2pConditioning(ray, point, ray, Eigen::Vector3d(2, 2, 3)), 0);
  EXPECT_EQ(Up2pConditioning(ray, point, other, point), 0);
}

TEST(Up2p, TheGateOfASampleIsItsConditioning) {
  Random random = TestRandom();
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d n = random.Uniform(0.1, 10) * RandomDirection(random);
    const Eigen::Vector3d d = random.Uniform(0.1, 10) * RandomDirection(random);
    const double w = YawConditioning(n, d);
    if (w > 0.01) {
      EXPECT_TRUE(IsYawConditioned(n, d, 0.999 * w));
    }
    EXPECT_FALSE(IsYawConditioned(n, d, 1.001 * w + 1e-6));
  }
  EXPECT_FALSE(IsYawConditioned(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), 0.0));
}

TEST(Up2p, ConditioningSeesPointsAboveEachOther) {
  // Level camera; aligned frame: z up. A vertical pair: any yaw explains it.
  const Eigen::Vector3d point1(3, 0, 0);
  const Eigen::Vector3d point2(3, 0, 2);
  EXPECT_NEAR(Up2pConditioning(point1, point1, point2, point2), 0, 1e-12);
  const Eigen::Vector3d aside(5, 2, 2);
  EXPECT_GT(Up2pConditioning(point1, point1, aside, aside), 0.1);
}

TEST(Up2p, ConditioningSeesPairsOnTheHorizon) {
  const Eigen::Vector3d point1(3, 0.5, 0);
  const Eigen::Vector3d point2(5, -2, 0);  // both at the camera's height
  EXPECT_NEAR(Up2pConditioning(point1, point1, point2, point2), 0, 1e-12);
  const Eigen::Vector3d higher(5, -2, 2);
  EXPECT_GT(Up2pConditioning(point1, point1, higher, higher), 0.1);
}

TEST(Up2p, ConditioningPredictsTheYawErrorOfANoisyRay) {
  Random random = TestRandom();
  std::vector<double> ratios;
  for (int i = 0; i < 5000; ++i) {
    const UprightScene scene = MakeScene(random);
    const PairOfPoints pair = MakePair(scene, random);
    const Eigen::Quaterniond aligned_from_camera =
        CameraFromAligned(scene.gravity_in_camera).conjugate();
    const Eigen::Vector3d x1 = aligned_from_camera * pair.ray1;
    const Eigen::Vector3d x2 = aligned_from_camera * pair.ray2;
    const double w = Up2pConditioning(x1, pair.point1, x2, pair.point2);
    const Eigen::Vector3d n = x1.cross(x2).normalized();
    if (w < 0.05 || x1.normalized().cross(x2.normalized()).norm() < 0.2) continue;
    // Turn the plane's normal by 1e-6 towards the direction of the pair, which moves the yaw most.
    const Eigen::Vector3d d =
        (scene.camera_from_map.rotation * (pair.point2 - pair.point1)).normalized();
    const double tilt = 1e-6;
    const Eigen::Vector3d turned = n + tilt * (aligned_from_camera * d);
    Yaw before[2], after[2];
    ASSERT_EQ(SolveYaw(MakeYawEquation(n, pair.point2 - pair.point1), before), 2);
    ASSERT_EQ(SolveYaw(MakeYawEquation(turned, pair.point2 - pair.point1), after), 2);
    double error = 10;
    const Eigen::Vector3d there = aligned_from_camera * d;
    for (int k = 0; k < 2; ++k) {
      // The solution that is the truth.
      const Eigen::Vector3d turned_d =
          TurnByYaw(before[k], (pair.point2 - pair.point1).normalized());
      if ((turned_d - there).norm() > 1e-6) continue;
      error = std::hypot(before[k].cosine - after[k].cosine, before[k].sine - after[k].sine);
    }
    ratios.push_back(error * w / tilt);
  }
  EXPECT_GT(ratios.size(), 1000u);
  EXPECT_NEAR(Percentile(ratios, 0.5), 1.0, 0.01);
}

// The paper's own road, equations (6) to (9), ends at the same poses.
TEST(Up2p, AgreesWithThePapersEquations) {
  Random random = TestRandom();
  std::vector<double> errors;
  for (int i = 0; i < 2000; ++i) {
    const UprightScene scene = MakeScene(random, RandomDirection(random));
    const PairOfPoints pair = MakePair(scene, random);
    const std::vector<Rigid3> paper =
        PaperTwoPoints(scene.gravity_in_camera, pair.ray1, pair.point1, pair.ray2, pair.point2);
    Rigid3 poses[2];
    const int count = Solve(scene, pair, poses);
    AddDifferences(poses, count, paper, &errors);
  }
  EXPECT_GE(errors.size(), 2000u);
  EXPECT_LT(Percentile(errors, 0.99), 1e-9);
}

}  // namespace
}  // namespace maploc::testing
