// The kernels for features with frames against the plain definition, on every target that the
// processor has.
#include <numbers>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "server/ransac/prepared_problem.h"
#include "server/ransac/scoring.h"
#include "tests/support/seed.h"
#include "tests/support/seen_through.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kThreshold = 4.0 / 400.0;
constexpr double kMinLength = 5.0 / 400.0;
const ScoringOptions kOptions = {static_cast<float>(kThreshold), static_cast<float>(kMinLength)};

class FrameScoring : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override {
    if ((hwy::SupportedTargets() & GetParam()) == 0) {
      GTEST_SKIP() << hwy::TargetName(GetParam()) << " is not on this processor";
    }
    hwy::SetSupportedTargetsForTest(GetParam());
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

struct SceneOnTheRim {
  PreparedProblem prepared;
  PoseMatrix pose;  // camera_from_centred
};

// On the rim of a lens of 220 degrees: some of it behind the plane z = 0.
SceneOnTheRim MakeScene(Random& random, int features) {
  SyntheticOptions options;
  options.scene = random.Below(2) == 0 ? Scene::kCube : Scene::kCorridor;
  options.point_inliers = options.line_inliers = features;
  options.point_outliers = options.line_outliers = features / 2;
  const SyntheticProblem made = MakeSyntheticProblem(options, random);
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(random.Uniform(0, 100) * kDegree, Eigen::Vector3d::UnitX()));
  SceneOnTheRim scene;
  scene.prepared = PrepareProblem(SeenThrough(FisheyeOf(220, 400), turn, made.problem), random);
  scene.pose =
      PoseMatrix({turn * made.camera_from_map.rotation, turn * made.camera_from_map.translation});
  scene.pose.translation += scene.pose.rotation * scene.prepared.centroid;
  return scene;
}

double PlainPointScore(const PoseMatrix& pose, const PointCorrespondence& point) {
  Eigen::Vector2d error;
  if (!PointReprojection(pose, point, &error, nullptr)) return 0;
  return std::max(0.0, 1.0 - error.squaredNorm() / (kThreshold * kThreshold));
}

double PlainLineScore(const PoseMatrix& pose, const LineCorrespondence& line) {
  Eigen::Vector2d error;
  if (!IsLineInlier(pose, line, kThreshold, kMinLength)) return 0;
  LineReprojection(pose, line, &error, nullptr);
  return 1.0 - 0.5 * error.squaredNorm() / (kThreshold * kThreshold);
}

TEST_P(FrameScoring, AgreesWithThePlainDefinition) {
  Random random = TestRandom();
  std::vector<std::uint32_t> places;
  for (int i = 0; i < 100; ++i) {
    SceneOnTheRim scene = MakeScene(random, 1 + static_cast<int>(random.Below(60)));
    const PreparedProblem& prepared = scene.prepared;
    ASSERT_TRUE(prepared.point_arrays.has_frames());
    if (i % 2 == 1) scene.pose.translation += 0.01 * RandomDirection(random);
    if (i % 10 == 9) scene.pose.translation *= -1;  // most of it on the other side
    double points = 0;
    for (const auto& point : prepared.centred.points) points += PlainPointScore(scene.pose, point);
    double lines = 0;
    for (const auto& line : prepared.centred.lines) lines += PlainLineScore(scene.pose, line);
    const ScoringPose pose = ToScoringPose(scene.pose);
    const Support by_points =
        ScorePoints(prepared.point_arrays, 0, prepared.point_arrays.x.size(), pose, kOptions);
    const Support by_lines =
        ScoreLines(prepared.line_arrays, 0, prepared.line_arrays.x.size(), pose, kOptions);
    EXPECT_NEAR(by_points.score, points, 1e-3 * (1 + points));
    EXPECT_NEAR(by_lines.score, lines, 5e-3 * (1 + lines));
    EXPECT_EQ(FindScoringPoints(prepared.point_arrays, pose, kOptions, &places),
              static_cast<std::size_t>(by_points.inliers));
    EXPECT_EQ(FindScoringLines(prepared.line_arrays, pose, kOptions, &places),
              static_cast<std::size_t>(by_lines.inliers));
  }
}

TEST_P(FrameScoring, PaddingNeverScores) {
  Random random = TestRandom();
  for (const int features : {1, 15, 16, 17}) {
    const SceneOnTheRim scene = MakeScene(random, features);
    const ScoringPose pose = ToScoringPose(scene.pose);
    const ScoringOptions lenient = {100.0f, 0.0f};
    const PointArrays& points = scene.prepared.point_arrays;
    EXPECT_LE(ScorePoints(points, 0, points.x.size(), pose, lenient).inliers,
              static_cast<int>(points.count));
    const LineArrays& lines = scene.prepared.line_arrays;
    EXPECT_LE(ScoreLines(lines, 0, lines.x.size(), pose, lenient).inliers,
              static_cast<int>(lines.count));
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, FrameScoring, ::testing::Values(HWY_SSE4, HWY_AVX2, HWY_AVX3));

}  // namespace
}  // namespace maploc::testing
