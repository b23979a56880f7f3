#include "server/ransac/sampler.h"

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

SyntheticProblem MakeScene(Random& random, int points, int lines, double vertical_share = 0) {
  SyntheticOptions options;
  options.point_inliers = points;
  options.line_inliers = lines;
  options.vertical_line_share = vertical_share;
  options.noise_px = 0;
  return MakeSyntheticProblem(options, random);
}

TEST(Sampler, KnowsWhatCannotBeDrawn) {
  Random random = TestRandom();
  const auto can_draw = [&](int points, int lines, Strategy strategy) {
    const SyntheticProblem made = MakeScene(random, points, lines);
    PoseProblem problem = made.problem;
    const PreparedProblem prepared = PrepareProblem(problem, random);
    return Sampler(prepared, strategy).CanDraw();
  };
  EXPECT_FALSE(can_draw(0, 0, Strategy::kMixed));
  EXPECT_FALSE(can_draw(1, 0, Strategy::kMixed));
  EXPECT_FALSE(can_draw(0, 5, Strategy::kMixed));
  EXPECT_TRUE(can_draw(2, 0, Strategy::kMixed));
  EXPECT_FALSE(can_draw(1, 5, Strategy::k2P));
  EXPECT_TRUE(can_draw(2, 0, Strategy::k2P));
  EXPECT_FALSE(can_draw(5, 0, Strategy::k1P1L));
  EXPECT_FALSE(can_draw(2, 5, Strategy::kP3P));
}

TEST(Sampler, AVerticalLineIsNotUsable) {
  Random random = TestRandom();
  const SyntheticProblem made = MakeScene(random, 1, 1, 1.0);
  const PreparedProblem prepared = PrepareProblem(made.problem, random);
  EXPECT_EQ(prepared.usable_lines.size(), 0u);
  EXPECT_EQ(prepared.vertical_lines.size(), 1u);
  EXPECT_FALSE(Sampler(prepared, Strategy::k1P1L).CanDraw());
}

// Without noise every sample that passes its gates holds the truth among its poses.
TEST(Sampler, EverySampleOfInliersHoldsTheTruth) {
  Random random = TestRandom();
  for (const Strategy strategy :
       {Strategy::k1P1L, Strategy::k2P, Strategy::kMixed, Strategy::kP3P}) {
    for (const double vertical_share : {0.0, 0.9}) {
      int solved = 0;
      int held = 0;
      for (int i = 0; i < 40; ++i) {
        const SyntheticProblem made = MakeScene(random, 20, 20, vertical_share);
        const PreparedProblem prepared = PrepareProblem(made.problem, random);
        Sampler sampler(prepared, strategy);
        for (int draw = 0; draw < 20; ++draw) {
          const Hypotheses& drawn = sampler.Draw(random);
          if (drawn.count == 0) continue;
          ++solved;
          bool found = false;
          for (int k = 0; k < drawn.count; ++k) {
            const Rigid3 pose = UncentredPose(prepared, drawn.camera_from_centred[k]);
            found |= ComparePoses(pose, made.camera_from_map).rotation_rad < 1e-4;
          }
          held += found ? 1 : 0;
        }
      }
      EXPECT_GT(solved, 200) << StrategyName(strategy);
      // P3P near its danger cylinder may miss one.
      EXPECT_GE(held, solved - solved / 200) << StrategyName(strategy) << " " << vertical_share;
    }
  }
}

TEST(Sampler, GatesRelaxWhereFewPassThem) {
  Random random = TestRandom();
  // All true, all within 6 px of each other: below the gate of 10 px, but all that there is.
  PoseProblem problem;
  problem.focal_length_px = 500;
  const SyntheticProblem made = MakeScene(random, 1, 0);
  problem.gravity_in_camera = made.problem.gravity_in_camera;
  const Eigen::Vector2d middle = made.problem.points[0].normalized;
  for (int i = 0; i < 20; ++i) {
    PointCorrespondence point;
    point.normalized =
        middle + Eigen::Vector2d(random.Uniform(-3, 3), random.Uniform(-3, 3)) / 500.0;
    point.position_in_map = made.camera_from_map.Inverse() *
                            Eigen::Vector3d(random.Uniform(2, 6) * point.normalized.homogeneous());
    problem.points.push_back(point);
  }
  const PreparedProblem prepared = PrepareProblem(problem, random);
  Sampler sampler(prepared, Strategy::k2P);
  int early = 0;
  int late = 0;
  for (int draw = 0; draw < 64; ++draw) early += sampler.Draw(random).count > 0 ? 1 : 0;
  for (int draw = 0; draw < 640; ++draw) sampler.Draw(random);
  for (int draw = 0; draw < 64; ++draw) late += sampler.Draw(random).count > 0 ? 1 : 0;
  EXPECT_EQ(early, 0);
  EXPECT_GT(late, 10);
}

}  // namespace
}  // namespace maploc::testing
