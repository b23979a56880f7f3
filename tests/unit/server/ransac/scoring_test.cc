#include "server/ransac/scoring.h"

#include <gtest/gtest.h>

#include "server/ransac/prepared_problem.h"
#include "server/solvers/reprojection.h"
#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr double kThreshold = 4.0 / 500.0;
constexpr double kMinLength = 5.0 / 500.0;
const ScoringOptions kOptions = {static_cast<float>(kThreshold), static_cast<float>(kMinLength)};

// The contract of scoring.h in double precision, one feature at a time.
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

SyntheticProblem MakeScene(Random& random, int features) {
  SyntheticOptions options;
  options.scene = random.Below(2) == 0 ? Scene::kCube : Scene::kCorridor;
  options.point_inliers = features;
  options.point_outliers = features / 2;
  options.line_inliers = features;
  options.line_outliers = features / 2;
  return MakeSyntheticProblem(options, random);
}

TEST(Scoring, AgreesWithThePlainDefinition) {
  Random random = TestRandom();
  for (int i = 0; i < 100; ++i) {
    const SyntheticProblem made = MakeScene(random, 1 + static_cast<int>(random.Below(60)));
    const PreparedProblem prepared = PrepareProblem(made.problem, random);
    PoseMatrix pose(made.camera_from_map);
    pose.translation += pose.rotation * prepared.centroid;
    // Half of the poses are a little off, so that scores between 0 and 1 are common.
    if (i % 2 == 1) pose.translation += 0.01 * RandomDirection(random);
    double points = 0;
    for (const auto& point : prepared.centred.points) points += PlainPointScore(pose, point);
    double lines = 0;
    for (const auto& line : prepared.centred.lines) lines += PlainLineScore(pose, line);
    const ScoringPose scoring = ToScoringPose(pose);
    const Support by_points =
        ScorePoints(prepared.point_arrays, 0, prepared.point_arrays.x.size(), scoring, kOptions);
    const Support by_lines =
        ScoreLines(prepared.line_arrays, 0, prepared.line_arrays.x.size(), scoring, kOptions);
    EXPECT_NEAR(by_points.score, points, 1e-3 * (1 + points));
    EXPECT_NEAR(by_lines.score, lines, 5e-3 * (1 + lines));
  }
}

TEST(Scoring, PaddingNeverScores) {
  PointArrays points;
  const float ahead[] = {0, 0, 2};
  points.Add(ahead, 0, 0);
  points.Pad();
  LineArrays lines;
  const float start[] = {-1, 0, 2}, direction[] = {2, 0, 0}, seen[] = {-0.1f, 0, 0.1f, 0};
  lines.Add(start, direction, seen);
  lines.Pad();
  const ScoringPose identity = ToScoringPose(PoseMatrix());
  const Support by_points = ScorePoints(points, 0, points.x.size(), identity, kOptions);
  EXPECT_EQ(by_points.inliers, 1);
  EXPECT_FLOAT_EQ(static_cast<float>(by_points.score), 1.0f);
  EXPECT_EQ(ScoreLines(lines, 0, lines.x.size(), identity, kOptions).inliers, 1);
  EXPECT_EQ(points.count, 1u);
}

TEST(Scoring, BehindTheCameraAndDotsScoreNothing) {
  PointArrays points;
  const float behind_camera[] = {0, 0, -2};
  points.Add(behind_camera, 0, 0);
  points.Pad();
  LineArrays lines;
  const float seen[] = {-0.1f, 0, 0.1f, 0};
  const float behind[] = {-1, 0, -2}, far[] = {-1, 0, 5000}, direction[] = {2, 0, 0};
  lines.Add(behind, direction, seen);
  lines.Add(far, direction, seen);
  lines.Pad();
  const ScoringPose identity = ToScoringPose(PoseMatrix());
  EXPECT_EQ(ScorePoints(points, 0, points.x.size(), identity, kOptions).inliers, 0);
  EXPECT_EQ(ScoreLines(lines, 0, lines.x.size(), identity, kOptions).inliers, 0);
}

TEST(Scoring, BlocksAddUpToTheWhole) {
  Random random = TestRandom();
  const SyntheticProblem made = MakeScene(random, 200);
  const PreparedProblem prepared = PrepareProblem(made.problem, random);
  PoseMatrix pose(made.camera_from_map);
  pose.translation += pose.rotation * prepared.centroid;
  const ScoringPose scoring = ToScoringPose(pose);
  const std::size_t size = prepared.point_arrays.x.size();
  Support parts;
  for (std::size_t i = 0; i < size; i += kScoringPad) {
    parts += ScorePoints(prepared.point_arrays, i, i + kScoringPad, scoring, kOptions);
  }
  const Support whole = ScorePoints(prepared.point_arrays, 0, size, scoring, kOptions);
  EXPECT_EQ(parts.inliers, whole.inliers);
  EXPECT_NEAR(parts.score, whole.score, 1e-3);
}

// The same features score, whichever kernel is asked; only rounding at the threshold may differ.
TEST(Scoring, FindsThePlacesOfWhatScores) {
  Random random = TestRandom();
  std::vector<std::uint32_t> places;
  for (const int features : {1, 15, 16, 17, 200}) {
    const SyntheticProblem made = MakeScene(random, features);
    const PreparedProblem prepared = PrepareProblem(made.problem, random);
    PoseMatrix pose(made.camera_from_map);
    pose.translation += pose.rotation * prepared.centroid;
    const ScoringPose scoring = ToScoringPose(pose);
    const Support points =
        ScorePoints(prepared.point_arrays, 0, prepared.point_arrays.x.size(), scoring, kOptions);
    ASSERT_EQ(FindScoringPoints(prepared.point_arrays, scoring, kOptions, &places),
              static_cast<std::size_t>(points.inliers));
    for (int i = 0; i < points.inliers; ++i) {
      const auto& point = prepared.centred.points[prepared.point_places.feature_at[places[i]]];
      EXPECT_TRUE(IsPointInlier(pose, point, 1.01 * kThreshold));
    }
    const Support lines =
        ScoreLines(prepared.line_arrays, 0, prepared.line_arrays.x.size(), scoring, kOptions);
    ASSERT_EQ(FindScoringLines(prepared.line_arrays, scoring, kOptions, &places),
              static_cast<std::size_t>(lines.inliers));
    for (int i = 0; i < lines.inliers; ++i) {
      const auto& line = prepared.centred.lines[prepared.line_places.feature_at[places[i]]];
      EXPECT_TRUE(IsLineInlier(pose, line, 1.01 * kThreshold, 0.99 * kMinLength));
    }
  }
}

}  // namespace
}  // namespace maploc::testing
