#include "server/solvers/up1p1l.h"

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/unit/server/solvers/paper_route.h"
#include "tests/unit/server/solvers/recovery.h"
#include "tests/unit/server/solvers/upright_scene.h"
#include "tests/unit/server/solvers/with_gravity.h"

namespace maploc::testing {
namespace {

struct PointAndLine {
  Eigen::Vector3d ray, point;
  Eigen::Vector3d end_ray1, end_ray2;  // of the image line
  Eigen::Vector3d line1, line2;        // end points of the map line, not those of the image line

  Eigen::Vector3d normal() const { return end_ray1.cross(end_ray2); }
  Eigen::Vector3d direction() const { return line2 - line1; }
};

PointAndLine MakePointAndLine(const UprightScene& scene, Random& random, double scale = 1.0) {
  PointAndLine made;
  made.ray = RandomRay(random);
  made.point = scene.PointInMap(made.ray, scale * random.Uniform(1, 10));
  made.end_ray1 = RandomRay(random);
  made.end_ray2 = RandomRay(random);
  const Eigen::Vector3d a = scene.PointInMap(made.end_ray1, scale * random.Uniform(1, 10));
  const Eigen::Vector3d b = scene.PointInMap(made.end_ray2, scale * random.Uniform(1, 10));
  made.line1 = a + random.Uniform(-0.5, 0.2) * (b - a);
  made.line2 = b + random.Uniform(-0.2, 0.5) * (b - a);
  return made;
}

int Solve(const UprightScene& scene, const PointAndLine& sample, Rigid3 poses[2]) {
  return SolveUp1p1l(scene.gravity_in_camera, sample.ray, sample.point, sample.normal(),
                     sample.line1, sample.direction(), poses);
}

PoseError SolvedError(const UprightScene& scene, const PointAndLine& sample) {
  Rigid3 poses[2];
  const int count = Solve(scene, sample, poses);
  return BestError(poses, count, scene.camera_from_map);
}

TEST(Up1p1l, RecoversRandomPoses) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random = TestRandom(seed);
    const Errors errors = ErrorsOver(kManyProblems, [&](int) {
      const UprightScene scene = MakeScene(random, 3.0 * RandomDirection(random));
      return SolvedError(scene, MakePointAndLine(scene, random));
    });
    ExpectRecovered(errors, {.percent999_rad = 1e-11});
    EXPECT_LT(Percentile(errors.rotation_rad, kAllButFive), 1e-7);
  }
}

// The ends of the image line one degree apart, and the point one degree from it.
TEST(Up1p1l, RaysOneDegreeApart) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(20000, [&](int) {
    const UprightScene scene = MakeScene(random);
    PointAndLine sample = MakePointAndLine(scene, random);
    const Eigen::Vector3d across = sample.end_ray1.cross(RandomDirection(random)).normalized();
    sample.end_ray2 = Eigen::AngleAxisd(kDegree, across) * sample.end_ray1;
    const Eigen::Vector3d along = across.cross(sample.end_ray1).normalized();
    sample.ray = Eigen::AngleAxisd(kDegree, along) * sample.end_ray1;
    sample.point = scene.PointInMap(sample.ray, random.Uniform(1, 10));
    sample.line1 = scene.PointInMap(sample.end_ray1, random.Uniform(1, 10));
    sample.line2 = scene.PointInMap(sample.end_ray2, random.Uniform(1, 10));
    return SolvedError(scene, sample);
  });
  // The rays' rounding against one degree, 60 times that of the others.
  ExpectRecovered(errors, {.percent99_rad = 1e-11});
}

TEST(Up1p1l, NoYawIsSpecial) {
  Random random = TestRandom();
  ExpectNoYawIsSpecial(random, [&](const UprightScene& scene) {
    return SolvedError(scene, MakePointAndLine(scene, random));
  });
}

TEST(Up1p1l, HorizontalLinesAwayFromTheHorizonAreNotDegenerate) {
  Random random = TestRandom();
  for (int i = 0; i < 2000; ++i) {
    const UprightScene scene = MakeScene(random);
    PointAndLine sample = MakePointAndLine(scene, random);
    const double angle = random.Uniform(0, 2 * std::numbers::pi);
    sample.line2 = sample.line1 + Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    // The image line may be seen anywhere along the map line, also by rays behind the image.
    sample.end_ray1 = scene.camera_from_map * sample.line1;
    sample.end_ray2 = scene.camera_from_map * sample.line2;
    const Eigen::Quaterniond aligned_from_camera =
        CameraFromAligned(scene.gravity_in_camera).conjugate();
    if (YawConditioning(aligned_from_camera * sample.normal(), sample.direction()) < 0.05) {
      continue;
    }
    EXPECT_LT(SolvedError(scene, sample).rotation_rad, 1e-9) << "problem " << i;
  }
}

TEST(Up1p1l, MapFiveHundredKilometresFromItsOrigin) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(20000, [&](int) {
    const UprightScene scene = MakeScene(random, kFarAway);
    PointAndLine sample = MakePointAndLine(scene, random);
    sample.ray = scene.RayTo(sample.point);
    sample.end_ray1 = scene.RayTo(sample.line1);
    sample.end_ray2 = scene.RayTo(sample.line2);
    return SolvedError(scene, sample);
  });
  ExpectRecovered(errors, {.percent999_rad = 1e-11});
  EXPECT_LE(Percentile(errors.position, 0.999), kFarPositionError);
}

TEST(Up1p1l, ScenesOfCentimetres) {
  Random random = TestRandom();
  const Errors errors = ErrorsOver(20000, [&](int) {
    const UprightScene scene = MakeScene(random, 0.01 * RandomDirection(random));
    return SolvedError(scene, MakePointAndLine(scene, random, 0.01));
  });
  ExpectRecovered(errors, {.percent999_rad = 1e-11});
}

TEST(Up1p1l, AVerticalLineGivesNoYaw) {
  const Eigen::Vector3d normal(0.5, 1, 0);  // aligned: a plane that holds the vertical
  const Eigen::Vector3d up(0, 0, 2);
  EXPECT_EQ(YawConditioning(normal, up), 0);
  AlignedPose poses[2];
  EXPECT_EQ(SolveUp1p1l({1, 0, 0}, {3, 0, 0}, normal, {4, 1, 0}, up, poses), 0);
}

TEST(Up1p1l, AHorizontalLineAtTheCamerasHeightIsDegenerate) {
  const Eigen::Vector3d normal(0, 0, 1);  // the horizon's plane
  const Eigen::Vector3d level(1, 2, 0);
  EXPECT_EQ(YawConditioning(normal, level), 0);
}

TEST(Up1p1l, OnAWallSeenHeadOnLinesThroughTheFootOfTheAxisAreDegenerate) {
  // Level camera at the origin looking along x at the wall x = 4; the foot of the axis is (4, 0,
  // 0).
  const Eigen::Vector3d foot(4, 0, 0);
  const Eigen::Vector3d slanted(0, 1, 1);
  EXPECT_NEAR(YawConditioning(foot.cross(foot + slanted), slanted), 0, 1e-12);
  const Eigen::Vector3d aside(4, 2, -1);
  EXPECT_GT(YawConditioning(aside.cross(aside + slanted), slanted), 0.1);
}

TEST(Up1p1l, APointOnTheImageLineHasNoDepth) {
  const Eigen::Vector3d ray(0.25, 0.5, 1);
  const Eigen::Vector3d normal = ray.cross(Eigen::Vector3d(1, 0, 1));
  AlignedPose poses[2];
  EXPECT_EQ(SolveUp1p1l(Eigen::Vector3d::Zero(), {1, 1, 1}, normal, {2, 1, 0}, {1, 0, 0}, poses),
            0);
}

// The paper's own road, through the frames C1 and W1, ends at the same poses.
TEST(Up1p1l, AgreesWithThePapersFrames) {
  Random random = TestRandom();
  std::vector<double> errors;
  for (int i = 0; i < 2000; ++i) {
    const UprightScene scene = MakeScene(random, RandomDirection(random));
    const PointAndLine sample = MakePointAndLine(scene, random);
    const std::vector<Rigid3> paper =
        PaperOnePointOneLine(scene.gravity_in_camera, sample.ray, sample.point, sample.end_ray1,
                             sample.end_ray2, sample.line1, sample.line2);
    Rigid3 poses[2];
    const int count = Solve(scene, sample, poses);
    AddDifferences(poses, count, paper, &errors);
  }
  EXPECT_GE(errors.size(), 2000u);
  EXPECT_LT(Percentile(errors, 0.99), 1e-9);
}

}  // namespace
}  // namespace maploc::testing
