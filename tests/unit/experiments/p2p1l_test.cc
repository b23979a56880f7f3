#include "tests/experiments/methods/p2p1l.h"

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/unit/server/solvers/recovery.h"
#include "tests/unit/server/solvers/upright_scene.h"

namespace maploc::testing {
namespace {

struct Sample {
  Eigen::Vector3d rays[2], points[2];
  Eigen::Vector3d normal, line_point, line_direction;

  int Solve(Rigid3 poses[8]) const {
    return SolveP2p1l(rays, points, normal, line_point, line_direction, poses);
  }
};

PoseError SolvedError(const Sample& sample, const Rigid3& truth) {
  Rigid3 poses[8];
  const int count = sample.Solve(poses);
  EXPECT_LE(count, 2);
  return BestError(poses, count, truth);
}

void SetLine(const UprightScene& scene, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
             Sample* sample) {
  sample->line_point = a + 0.3 * (b - a);
  sample->line_direction = b - a;
  sample->normal = (scene.camera_from_map * a).cross(scene.camera_from_map * b);
}

Sample MakeSample(const UprightScene& scene, Random& random, double scale = 1.0) {
  Sample sample;
  for (int i = 0; i < 2; ++i) {
    sample.rays[i] = RandomRay(random);
    sample.points[i] = scene.PointInMap(sample.rays[i], scale * random.Uniform(1, 10));
  }
  const Eigen::Vector3d a = scene.PointInMap(RandomRay(random), scale * random.Uniform(1, 10));
  const Eigen::Vector3d b = scene.PointInMap(RandomRay(random), scale * random.Uniform(1, 10));
  SetLine(scene, a, b, &sample);
  return sample;
}

TEST(P2p1l, RecoversRandomPoses) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(kManyProblems, [&](int) {
    const UprightScene scene = MakeScene(random, 3.0 * RandomDirection(random));
    return SolvedError(MakeSample(scene, random), scene.camera_from_map);
  });
  EXPECT_LT(Percentile(errors.rotation_rad, 0.5), 1e-14);
  EXPECT_LT(Percentile(errors.rotation_rad, 0.999), 1e-10);
  // The worst of 100,000 lies near a double root, where the error is the root of the rounding's.
  EXPECT_LT(Percentile(errors.rotation_rad, 1.0), 1e-3) << "a pose was missed";
  EXPECT_LT(Percentile(errors.position, 0.999), 1e-9);
}

TEST(P2p1l, EveryPoseIsOne) {
  Random random = TestRandom();
  int two = 0;
  for (int i = 0; i < 5000; ++i) {
    const UprightScene scene = MakeScene(random);
    const Sample sample = MakeSample(scene, random);
    Rigid3 poses[8];
    const int count = sample.Solve(poses);
    two += count == 2 ? 1 : 0;
    const Eigen::Vector3d n = sample.normal.normalized();
    for (int k = 0; k < count; ++k) {
      for (int j = 0; j < 2; ++j) {
        const Eigen::Vector3d q = poses[k] * sample.points[j];
        EXPECT_GT(q.z(), 0);
        EXPECT_LT((q / q.z() - sample.rays[j]).norm(), 1e-6) << "problem " << i;
      }
      EXPECT_NEAR(n.dot(poses[k] * sample.line_point), 0, 1e-7) << "problem " << i;
      EXPECT_NEAR(n.dot(poses[k].rotation * sample.line_direction.normalized()), 0, 1e-7);
    }
  }
  EXPECT_GT(two, 500) << "the second solution is lost";
}

// Features of one wall: the line meets the line through the points, or runs along it.
TEST(P2p1l, ALineInThePlaneOfThePairIsNotDegenerate) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(5000, [&](int i) {
    const UprightScene scene = MakeScene(random, RandomDirection(random));
    Sample sample = MakeSample(scene, random);
    const Eigen::Vector3d pair = sample.points[1] - sample.points[0];
    const Eigen::Vector3d aside = scene.PointInMap(RandomRay(random), random.Uniform(1, 10));
    const Eigen::Vector3d along = sample.points[0] + random.Uniform(-1, 2) * pair;
    SetLine(scene, aside, i % 2 == 0 ? along : Eigen::Vector3d(aside + pair), &sample);
    return SolvedError(sample, scene.camera_from_map);
  });
  EXPECT_LT(Percentile(errors.rotation_rad, 0.99), 1e-10);
  EXPECT_LT(Percentile(errors.rotation_rad, 1.0), 1e-3);
}

TEST(P2p1l, ScenesOfCentimetresAndMapsFarAway) {
  Random random = TestRandom();
  Errors small;
  Errors far;
  for (int i = 0; i < 5000; ++i) {
    const UprightScene tiny = MakeScene(random, 0.01 * RandomDirection(random));
    small.Add(SolvedError(MakeSample(tiny, random, 0.01), tiny.camera_from_map));
    const UprightScene away = MakeScene(random, kFarAway);
    Sample distant = MakeSample(away, random);
    for (int k = 0; k < 2; ++k) distant.rays[k] = away.RayTo(distant.points[k]);
    distant.normal = away.RayTo(distant.line_point)
                         .cross(away.camera_from_map.rotation * distant.line_direction);
    far.Add(SolvedError(distant, away.camera_from_map));
  }
  EXPECT_LT(Percentile(small.rotation_rad, 0.99), 1e-11);
  EXPECT_LT(Percentile(far.rotation_rad, 0.99), 1e-11);
}

TEST(P2p1l, DegenerateSamplesHaveNoSolution) {
  const Eigen::Vector3d rays[2] = {{0.1, 0, 1}, {-0.2, 0.1, 1}};
  const Eigen::Vector3d points[2] = {{0.4, 0, 4}, {-0.6, 0.3, 3}};
  const Eigen::Vector3d through_a_ray = rays[0].cross(Eigen::Vector3d(1, 1, 1));
  const Eigen::Vector3d equal[2] = {points[0], points[0]};
  Rigid3 poses[8];
  EXPECT_EQ(SolveP2p1l(rays, points, Eigen::Vector3d::Zero(), {0, 1, 2}, {1, 0, 0}, poses), 0);
  EXPECT_EQ(SolveP2p1l(rays, points, through_a_ray, {0, 1, 2}, {1, 1, 1}, poses), 0);
  EXPECT_EQ(SolveP2p1l(rays, equal, {0, 1, 0.5}, {0, 1, 2}, {1, 0, 0}, poses), 0);
}

}  // namespace
}  // namespace maploc::testing
