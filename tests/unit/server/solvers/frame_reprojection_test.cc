// The errors of features with frames: in pixels of the real image, at any angle off the axis.
#include <numbers>

#include <gtest/gtest.h>

#include "server/solvers/reprojection.h"
#include "tests/support/seed.h"
#include "tests/support/seen_through.h"
#include "tests/unit/server/solvers/numeric_jacobian.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// The scene of a pinhole on the rim of a lens of 220 degrees: some of it behind the plane z = 0.
struct OnTheRim {
  Camera camera = FisheyeOf(220, 400);
  PoseMatrix pose;
  PoseProblem problem;

  explicit OnTheRim(Random& random, double noise_px = 1.0) {
    SyntheticOptions options;
    options.point_inliers = 5;
    options.line_inliers = 5;
    options.noise_px = noise_px;
    const SyntheticProblem made = MakeSyntheticProblem(options, random);
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(random.Uniform(0, 2 * std::numbers::pi), Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(random.Uniform(60, 90) * kDegree, Eigen::Vector3d::UnitX()) *
        Eigen::Quaterniond::Identity();
    pose =
        PoseMatrix({turn * made.camera_from_map.rotation, turn * made.camera_from_map.translation});
    problem = SeenThrough(camera, turn, made.problem);
  }
};

TEST(FrameReprojection, JacobiansAgreeWithDifferences) {
  Random random = TestRandom();
  int looked_at = 0;
  for (int i = 0; i < 200; ++i) {
    const OnTheRim scene(random);
    Eigen::Vector2d error;
    Jacobian26 jacobian;
    for (const PointCorrespondence& point : scene.problem.points) {
      ASSERT_TRUE(point.frame.has_value());
      ASSERT_TRUE(PointReprojection(scene.pose, point, &error, &jacobian));
      const Jacobian26 numeric = NumericJacobian(scene.pose, [&](const PoseMatrix& moved) {
        Eigen::Vector2d e;
        EXPECT_TRUE(PointReprojection(moved, point, &e, nullptr));
        return e;
      });
      EXPECT_LT((jacobian - numeric).norm(), 1e-6 * (1 + numeric.norm()));
      ++looked_at;
    }
    for (const LineCorrespondence& line : scene.problem.lines) {
      ASSERT_TRUE(LineReprojection(scene.pose, line, &error, &jacobian));
      const Jacobian26 numeric = NumericJacobian(scene.pose, [&](const PoseMatrix& moved) {
        Eigen::Vector2d e;
        EXPECT_TRUE(LineReprojection(moved, line, &e, nullptr));
        return e;
      });
      EXPECT_LT((jacobian - numeric).norm(), 1e-5 * (1 + numeric.norm()));
      ++looked_at;
    }
  }
  EXPECT_GT(looked_at, 1500);
}

// What the error says, times the focal length, is how far apart the pixels are.
TEST(FrameReprojection, ErrorsArePixelsOfTheImage) {
  Random random = TestRandom();
  int behind = 0;
  for (int i = 0; i < 200; ++i) {
    const OnTheRim scene(random);
    const double focal = scene.problem.focal_length_px;
    for (const PointCorrespondence& point : scene.problem.points) {
      const Eigen::Vector3d q =
          scene.pose.rotation * point.position_in_map + scene.pose.translation;
      behind += q.z() < 0 ? 1 : 0;
      const Eigen::Vector2d seen = focal * point.normalized + scene.camera.principal_point_px();
      const auto projected = scene.camera.Project(q);
      if (!projected) continue;
      Eigen::Vector2d error;
      ASSERT_TRUE(PointReprojection(scene.pose, point, &error, nullptr));
      EXPECT_LT((focal * error - (*projected - seen)).norm(), 0.01 * (*projected - seen).norm());
    }
    for (const LineCorrespondence& line : scene.problem.lines) {
      // The seen start moved across by the told distance lies on the line's plane.
      Eigen::Vector2d error;
      ASSERT_TRUE(LineReprojection(scene.pose, line, &error, nullptr));
      const Eigen::Vector3d start =
          scene.pose.rotation * line.segment_in_map.start + scene.pose.translation;
      const Eigen::Vector3d end =
          scene.pose.rotation * line.segment_in_map.end + scene.pose.translation;
      const Eigen::Vector3d normal = start.cross(end).normalized();
      const Eigen::Vector2d seen =
          focal * line.normalized.start + scene.camera.principal_point_px();
      const auto off = [&](const Eigen::Vector2d& pixel) {
        const auto ray = scene.camera.Ray(pixel);
        return ray ? normal.dot(*ray) : 0.0;
      };
      const Eigen::Vector2d gradient(
          off(seen + Eigen::Vector2d(.5, 0)) - off(seen - Eigen::Vector2d(.5, 0)),
          off(seen + Eigen::Vector2d(0, .5)) - off(seen - Eigen::Vector2d(0, .5)));
      const double distance = off(seen) / gradient.norm();
      EXPECT_NEAR(std::abs(focal * error(0)), std::abs(distance), 0.01 * std::abs(distance) + 1e-3);
    }
  }
  EXPECT_GT(behind, 50);
}

TEST(FrameReprojection, OnTheOtherSideNothingAgrees) {
  Random random = TestRandom();
  for (int i = 0; i < 50; ++i) {
    const OnTheRim scene(random, 0.0);
    PoseMatrix behind = scene.pose;  // every landmark mirrored at the camera's centre
    behind.rotation *= -1;
    behind.translation *= -1;
    for (const PointCorrespondence& point : scene.problem.points) {
      EXPECT_TRUE(IsPointInlier(scene.pose, point, 0.002));
      EXPECT_FALSE(IsPointInlier(behind, point, 0.002));
    }
    for (const LineCorrespondence& line : scene.problem.lines) {
      EXPECT_TRUE(IsLineInlier(scene.pose, line, 0.002, 0.01));
      EXPECT_FALSE(IsLineInlier(behind, line, 0.002, 0.01));
      EXPECT_EQ(ProjectedLength(behind, line), 0.0);
    }
  }
}

TEST(FrameReprojection, ALineIsAsLongAsItIsSeen) {
  Random random = TestRandom();
  for (int i = 0; i < 50; ++i) {
    const OnTheRim scene(random, 0.0);
    for (const LineCorrespondence& line : scene.problem.lines) {
      // Straight in the image but for a little, and seen from end to end.
      const double seen = (line.normalized.end - line.normalized.start).norm();
      EXPECT_NEAR(ProjectedLength(scene.pose, line), seen, 0.35 * seen);
    }
  }
}

}  // namespace
}  // namespace maploc::testing
