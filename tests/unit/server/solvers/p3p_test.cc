#include "server/solvers/p3p.h"

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/unit/server/solvers/upright_scene.h"

namespace maploc::testing {
namespace {

struct Triple {
  Eigen::Vector3d rays[3];
  Eigen::Vector3d points[3];
};

Triple MakeTriple(const UprightScene& scene, Random& random, double scale = 1.0) {
  Triple triple;
  for (int i = 0; i < 3; ++i) {
    triple.rays[i] = RandomRay(random);
    triple.points[i] = scene.PointInMap(triple.rays[i], scale * random.Uniform(1, 10));
  }
  return triple;
}

TEST(P3p, RecoversRandomPoses) {
  Random random = TestRandom();
  std::vector<double> errors;
  int missed = 0;
  for (int i = 0; i < 20000; ++i) {
    const UprightScene scene = MakeScene(random, 3.0 * RandomDirection(random));
    const Triple triple = MakeTriple(scene, random);
    Rigid3 poses[4];
    const int count = SolveP3p(triple.rays, triple.points, poses);
    ASSERT_LE(count, 4);
    errors.push_back(BestRotationError(poses, count, scene.camera_from_map));
    missed += errors.back() > 1e-4 ? 1 : 0;
  }
  EXPECT_LE(missed, 4) << "of 20000";
  EXPECT_LT(Percentile(errors, 0.5), 1e-13);
  EXPECT_LT(Percentile(errors, 0.99), 1e-9);
}

TEST(P3p, EveryPoseSeesThePointsWhereTheyWereSeen) {
  Random random = TestRandom();
  for (int i = 0; i < 2000; ++i) {
    const UprightScene scene = MakeScene(random);
    const Triple triple = MakeTriple(scene, random);
    if (P3pConditioning(triple.rays, triple.points) < 1e-3) continue;
    Rigid3 poses[4];
    const int count = SolveP3p(triple.rays, triple.points, poses);
    for (int k = 0; k < count; ++k) {
      for (int j = 0; j < 3; ++j) {
        const Eigen::Vector3d q = poses[k] * triple.points[j];
        EXPECT_GT(q.z(), 0);
        EXPECT_LT((q / q.z() - triple.rays[j]).norm(), 1e-5) << "problem " << i;
      }
    }
  }
}

TEST(P3p, MapFarFromItsOriginAndScenesOfCentimetres) {
  Random random = TestRandom();
  std::vector<double> far;
  std::vector<double> small;
  for (int i = 0; i < 1000; ++i) {
    Rigid3 poses[4];
    const UprightScene away = MakeScene(random, Eigen::Vector3d(4e5, -3e5, 100));
    const Triple distant = MakeTriple(away, random);
    int count = SolveP3p(distant.rays, distant.points, poses);
    far.push_back(BestRotationError(poses, count, away.camera_from_map));
    const UprightScene tiny = MakeScene(random, 0.01 * RandomDirection(random));
    const Triple little = MakeTriple(tiny, random, 0.01);
    count = SolveP3p(little.rays, little.points, poses);
    small.push_back(BestRotationError(poses, count, tiny.camera_from_map));
  }
  EXPECT_LT(Percentile(far, 0.5), 1e-8);
  EXPECT_LT(Percentile(small, 0.5), 1e-13);
  EXPECT_LT(Percentile(small, 0.99), 1e-8);
}

TEST(P3p, PointsOnALineHaveNoSolution) {
  const Eigen::Vector3d rays[3] = {{0, 0, 1}, {0.1, 0, 1}, {0.2, 0, 1}};
  const Eigen::Vector3d points[3] = {{0, 0, 1}, {0, 0, 2}, {0, 0, 3}};
  Rigid3 poses[4];
  EXPECT_EQ(SolveP3p(rays, points, poses), 0);
  EXPECT_EQ(P3pConditioning(rays, points), 0);
}

}  // namespace
}  // namespace maploc::testing
