#include "server/solvers/reprojection.h"

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"
#include "tests/unit/server/solvers/numeric_jacobian.h"

namespace maploc::testing {
namespace {

SyntheticProblem MakeScene(Random& random) {
  SyntheticOptions options;
  options.point_inliers = 5;
  options.line_inliers = 5;
  return MakeSyntheticProblem(options, random);
}

TEST(Reprojection, JacobiansAgreeWithDifferences) {
  Random random = TestRandom();
  for (int i = 0; i < 200; ++i) {
    const SyntheticProblem made = MakeScene(random);
    const PoseMatrix pose(made.camera_from_map);
    Eigen::Vector2d error;
    Jacobian26 jacobian;
    for (const PointCorrespondence& point : made.problem.points) {
      ASSERT_TRUE(PointReprojection(pose, point, &error, &jacobian));
      const Jacobian26 numeric = NumericJacobian(pose, [&](const PoseMatrix& moved) {
        Eigen::Vector2d e;
        EXPECT_TRUE(PointReprojection(moved, point, &e, nullptr));
        return e;
      });
      EXPECT_LT((jacobian - numeric).norm(), 1e-6 * (1 + numeric.norm()));
    }
    for (const LineCorrespondence& line : made.problem.lines) {
      ASSERT_TRUE(LineReprojection(pose, line, &error, &jacobian));
      const Jacobian26 numeric = NumericJacobian(pose, [&](const PoseMatrix& moved) {
        Eigen::Vector2d e;
        EXPECT_TRUE(LineReprojection(moved, line, &e, nullptr));
        return e;
      });
      EXPECT_LT((jacobian - numeric).norm(), 1e-5 * (1 + numeric.norm()));
    }
  }
}

// Camera at the origin of the map, same axes.
TEST(Reprojection, PointErrorIsInThePlaneAtDepthOne) {
  const PointCorrespondence point{.normalized = {0.4, -0.2}, .position_in_map = {2, -1, 4}};
  Eigen::Vector2d error;
  ASSERT_TRUE(PointReprojection(PoseMatrix(), point, &error, nullptr));
  EXPECT_NEAR(error.x(), 0.1, 1e-15);
  EXPECT_NEAR(error.y(), -0.05, 1e-15);
}

TEST(Reprojection, BehindTheCameraNothingAgrees) {
  PointCorrespondence point;
  point.position_in_map = {0, 0, -4};  // projects onto the axis all the same
  const LineCorrespondence line{.normalized = {{-0.25, 0}, {0.25, 0}},
                                .segment_in_map = {{-1, 0, -4}, {1, 0, -4}}};
  EXPECT_FALSE(IsPointInlier(PoseMatrix(), point, 0.1));
  EXPECT_FALSE(IsLineInlier(PoseMatrix(), line, 0.1, 0.01));
}

TEST(Reprojection, LineErrorIsTheDistanceOfTheSeenEndPoints) {
  const LineCorrespondence line{
      .normalized = {{0.1, 0.53}, {0.2, 0.49}},    // elsewhere along the segment's image,
      .segment_in_map = {{-1, 1, 2}, {3, 1, 2}}};  // which is at y = 0.5
  Eigen::Vector2d error;
  ASSERT_TRUE(LineReprojection(PoseMatrix(), line, &error, nullptr));
  EXPECT_NEAR(std::abs(error(0)), 0.03, 1e-15);
  EXPECT_NEAR(std::abs(error(1)), 0.01, 1e-15);
  EXPECT_TRUE(IsLineInlier(PoseMatrix(), line, 0.031, 0.01));
  EXPECT_FALSE(IsLineInlier(PoseMatrix(), line, 0.029, 0.01));
}

TEST(Reprojection, ALineThatIsADotSaysNothing) {
  const LineCorrespondence line{.normalized = {{-0.1, 0}, {0.1, 0}},
                                .segment_in_map = {{-1, 0, 1000}, {1, 0, 1000}}};
  EXPECT_TRUE(IsLineInlier(PoseMatrix(), line, 0.01, 0.001));
  EXPECT_FALSE(IsLineInlier(PoseMatrix(), line, 0.01, 0.01));
}

TEST(Reprojection, ALineThatCrossesTheCamerasPlaneIsLong) {
  const LineCorrespondence line{
      .normalized = {{0.2, 0.2}, {0.5, 0.5}},
      .segment_in_map = {{1, 1, -3}, {1, 1, 5}}};  // beside the camera, along its axis
  EXPECT_TRUE(std::isinf(ProjectedLength(PoseMatrix(), line)));
  EXPECT_TRUE(IsLineInlier(PoseMatrix(), line, 0.01, 0.01));
}

TEST(Reprojection, FindInliersFindsTheTruth) {
  Random random = TestRandom();
  SyntheticOptions options;
  options.point_inliers = 30;
  options.point_outliers = 30;
  options.line_inliers = 10;
  options.noise_px = 0.5;
  const SyntheticProblem made = MakeSyntheticProblem(options, random);
  const InlierFlags flags = FindInliers(made.problem, made.camera_from_map, 4.0);
  int agree = 0;
  for (std::size_t i = 0; i < flags.points.size(); ++i) {
    agree += flags.points[i] == made.point_is_inlier[i] ? 1 : 0;
  }
  EXPECT_GE(agree, 59);  // an outlier may fall within 4 px by chance
  EXPECT_EQ(flags.lines, made.line_is_inlier);
}

}  // namespace
}  // namespace maploc::testing
