#include "server/trust/rival.h"

#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "server/ransac/estimator.h"
#include "server/trust/confidence.h"
#include "server/trust/judge.h"
#include "tests/support/repeated_pattern.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Judged {
  bool beyond_chance = false;  // the test against chance alone would tell it
  bool localized = false;
};

Judged Judge(const PoseProblem& problem, std::uint64_t seed) {
  RansacOptions ransac;
  ransac.seed = seed;
  const Consensus consensus = EstimateConsensus(problem, ransac);
  if (!consensus.found) return {};
  const RefinedPose pose = RefinePose(problem, consensus.camera_from_map, {});
  ConfidenceOptions confidence;
  confidence.iterations = consensus.iterations;
  const Camera camera =
      Camera::Create(CameraModel::kSimplePinhole, 640, 480, {500, 319.5, 239.5}).value();
  TrustOptions trust;
  trust.gravity_was_sent = true;
  trust.iterations = consensus.iterations;
  return {PoseConfidence(problem, pose, confidence) >= trust.min_confidence,
          JudgePose(problem, pose, camera, trust).outcome == Outcome::kLocalized};
}

struct Counts {
  int beyond_chance = 0;
  int localized = 0;
};

// `make` is called with 0, 1, ... problems - 1.
Counts JudgeAll(int problems, Random& random, const std::function<PoseProblem(int)>& make) {
  Counts counts;
  for (int i = 0; i < problems; ++i) {
    const PoseProblem problem = make(i);
    const Judged judged = Judge(problem, random.Next());
    counts.beyond_chance += judged.beyond_chance ? 1 : 0;
    counts.localized += judged.localized ? 1 : 0;
  }
  return counts;
}

// Wrong matches of a pattern in depth agree with a pose by no chance, and have no truth in them.
TEST(Rival, DoorsAlongACorridorAreNotBelieved) {
  Random random = TestRandom();
  const Counts counts = JudgeAll(360, random, [&](int i) {
    RepeatedCorridorOptions options;
    options.walls = 1 + i % 2;
    options.spots = i % 3 == 0 ? 3 : i % 3 == 1 ? 6 : 12;
    options.doors = 6 + 2 * (i / 6 % 3);
    return MakeRepeatedCorridor(options, random);
  });
  EXPECT_GT(counts.beyond_chance, 30) << "else the corridors test nothing";
  EXPECT_LE(counts.localized, 4) << "of 360; 10 of 7200 under seeds 1 to 20";
}

// What is left over under the true pose is wrong in many ways, and holds no other.
TEST(Rival, TruthHasNone) {
  Random random = TestRandom();
  const Counts counts = JudgeAll(150, random, [&](int i) {
    SyntheticOptions options;
    options.scene = i % 2 == 0 ? Scene::kCube : Scene::kCorridor;
    options.outliers = i % 4 < 2 ? Outliers::kRandomPixels : Outliers::kWrongAssociations;
    options.point_inliers = 12 + i % 20;
    options.point_outliers = 20 + 3 * (i % 40);
    options.line_inliers = i % 3 == 0 ? 0 : 10;
    options.line_outliers = i % 3 == 0 ? 0 : 20;
    options.gravity_noise_rad = options.gravity_sigma_rad = 1.0 * kDegree;
    return MakeSyntheticProblem(options, random).problem;
  });
  EXPECT_GT(counts.beyond_chance, 120);
  EXPECT_GE(counts.localized, counts.beyond_chance - counts.beyond_chance / 50);
}

TEST(Rival, NeedsSomethingLeftOver) {
  Random random = TestRandom();
  SyntheticOptions options;
  options.point_inliers = 20;
  options.point_outliers = 4;
  const SyntheticProblem made = MakeSyntheticProblem(options, random);
  const RefinedPose pose = RefinePose(made.problem, made.camera_from_map, {});
  EXPECT_FALSE(FindRival(made.problem, pose, InliersOfRival(pose.InlierCount()), {}));
  EXPECT_FALSE(LooksMirrored(made.problem, pose, {}));
}

// A gravity in a wrong frame leads the search to a pose of a few inliers; all others hold the true
// one, which gravity would never have found.
TEST(Rival, TheTruePoseWinsOverOneThatAWrongGravityFound) {
  Random random = TestRandom();
  int found = 0;
  for (int i = 0; i < 20; ++i) {
    SyntheticOptions options;
    options.point_inliers = 60;
    options.point_outliers = 20;
    SyntheticProblem made = MakeSyntheticProblem(options, random);
    made.problem.gravity_in_camera =
        Eigen::AngleAxisd(1.2, made.problem.gravity_in_camera.unitOrthogonal()) *
        made.problem.gravity_in_camera;
    RansacOptions ransac;
    ransac.seed = random.Next();
    const Consensus consensus = EstimateConsensus(made.problem, ransac);
    if (!consensus.found) continue;
    const RefinedPose wrong = RefinePose(made.problem, consensus.camera_from_map, {});
    if (ComparePoses(wrong.camera_from_map, made.camera_from_map).rotation_rad < 0.2) continue;
    ++found;
    const auto rival = FindRival(made.problem, wrong, InliersOfRival(wrong.InlierCount()), {});
    ASSERT_TRUE(rival.has_value());
    EXPECT_LT(ComparePoses(rival->camera_from_map, made.camera_from_map).rotation_rad, 0.02);
    EXPECT_GE(rival->InlierCount(), 50u);
  }
  EXPECT_GT(found, 5) << "else the gravity misled nobody";
}

// Points of one rigid thing 3 to 6 m away, within `half_width` of the image's centre (in focal
// lengths), as `camera_from_map` sees it.
void AddThing(const Rigid3& camera_from_map, int points, double half_width, Random& random,
              PoseProblem& problem) {
  for (int i = 0; i < points; ++i) {
    const double x = random.Uniform(-half_width, half_width);
    const double y = random.Uniform(-half_width, half_width);
    PointCorrespondence point;
    point.position_in_map =
        camera_from_map.Inverse() * (random.Uniform(3, 6) * Eigen::Vector3d(x, y, 1));
    point.normalized = {x + random.Gaussian(0.001), y + random.Gaussian(0.001)};
    problem.points.push_back(point);
  }
}

// What is LOCALIZED of 20 queries of a level camera before walls, and before a thing that is a
// metre from where the map has it.
int LocalizedBeforeMovedThing(int wall_points, int thing_points, double thing_half_width) {
  Random random = TestRandom();
  const Rigid3 camera_from_map;
  const Rigid3 camera_from_map_of_thing = {Eigen::Quaterniond::Identity(), {1, 0, 0}};
  return JudgeAll(20, random,
                  [&](int) {
                    PoseProblem problem;
                    problem.focal_length_px = 500;
                    problem.gravity_sigma_rad = 0.01;
                    AddThing(camera_from_map, wall_points, 0.6, random, problem);
                    AddThing(camera_from_map_of_thing, thing_points, thing_half_width, random,
                             problem);
                    return problem;
                  })
      .localized;
}

// A truck fills most of the picture: the few walls around it tell that it was moved.
TEST(Rival, AMovedTruckIsNotBelieved) { EXPECT_EQ(LocalizedBeforeMovedThing(30, 300, 0.4), 0); }

// A box with as many points as those walls had does not keep the walls from being believed.
TEST(Rival, WallsBesideAMovedBoxAreBelieved) {
  EXPECT_EQ(LocalizedBeforeMovedThing(300, 40, 0.12), 20);
}

// x of every feature turned over: a wrong pose finds some inliers, the mirror hypothesis all.
TEST(Rival, AMirroredPictureIsSeen) {
  Random random = TestRandom();
  for (int i = 0; i < 20; ++i) {
    SyntheticOptions options;
    options.point_inliers = 60;
    options.point_outliers = 10;
    SyntheticProblem made = MakeSyntheticProblem(options, random);
    for (PointCorrespondence& point : made.problem.points) point.normalized.x() *= -1.0;
    RansacOptions ransac;
    ransac.seed = random.Next();
    const Consensus consensus = EstimateConsensus(made.problem, ransac);
    if (!consensus.found) continue;
    EXPECT_TRUE(
        LooksMirrored(made.problem, RefinePose(made.problem, consensus.camera_from_map, {}), {}));
  }
}

}  // namespace
}  // namespace maploc::testing
