#include "server/ransac/pretest.h"

#include <gtest/gtest.h>

#include "tests/support/seed.h"
#include "tests/support/synthetic_problem.h"

namespace maploc::testing {
namespace {

constexpr ScoringOptions kOptions = {0.006f, 0.01f};

// 1000 points and 300 lines; the inliers of each kind as asked.
struct Scene1300 {
  SyntheticProblem made;
  PreparedProblem prepared;
  ScoringPose truth;

  Scene1300(int point_inliers, int line_inliers, Random& random) {
    SyntheticOptions options;
    options.point_inliers = point_inliers;
    options.point_outliers = 1000 - point_inliers;
    options.line_inliers = line_inliers;
    options.line_outliers = 300 - line_inliers;
    made = MakeSyntheticProblem(options, random);
    prepared = PrepareProblem(made.problem, random);
    PoseMatrix pose(made.camera_from_map);
    pose.translation += pose.rotation * prepared.centroid;
    truth = ToScoringPose(pose);
  }

  double Score() const {
    Support support =
        ScorePoints(prepared.point_arrays, 0, prepared.point_arrays.x.size(), truth, kOptions);
    support += ScoreLines(prepared.line_arrays, 0, prepared.line_arrays.x.size(), truth, kOptions);
    return support.score;
  }
};

ScoringPose RandomPose(const PreparedProblem& prepared, Random& random) {
  PoseMatrix pose(MakeCameraFromMap(Scene::kCube, random));
  pose.translation += pose.rotation * prepared.centroid;
  return ToScoringPose(pose);
}

double ShareThatPasses(const Scene1300& scene, bool truth, Random& random) {
  Pretest pretest(scene.prepared, kOptions);
  pretest.Update(scene.Score());
  constexpr int kHypotheses = 1000;
  int passed = 0;
  for (int i = 0; i < kHypotheses; ++i) {
    const ScoringPose pose = truth ? scene.truth : RandomPose(scene.prepared, random);
    passed += pretest.Passes({}, pose, random) ? 1 : 0;
  }
  return static_cast<double>(passed) / kHypotheses;
}

constexpr int kScenes = 5;  // of one alone .921 was seen in 20 seeds

// However the best score is divided between points and lines, a pose as good passes, and most
// others do not.
TEST(Pretest, KeepsWhatIsAsGoodAsTheBestWhereverItsInliersAre) {
  Random random = TestRandom();
  for (const auto& [points, lines] : {std::pair{60, 0}, {0, 60}, {30, 30}, {20, 90}}) {
    double kept = 0.0;
    for (int i = 0; i < kScenes; ++i) {
      const Scene1300 scene(points, lines, random);
      kept += ShareThatPasses(scene, true, random) / kScenes;
      EXPECT_LT(ShareThatPasses(scene, false, random), 0.6) << points << " points " << lines;
    }
    EXPECT_GT(kept, 0.93) << points << " points " << lines;
  }
}

TEST(Pretest, AsksNothingBeforeThereIsAGoodPose) {
  Random random = TestRandom();
  const Scene1300 scene(60, 60, random);
  Pretest pretest(scene.prepared, kOptions);
  const auto expect_all_pass = [&] {
    for (int i = 0; i < 100; ++i) {
      EXPECT_TRUE(pretest.Passes({}, RandomPose(scene.prepared, random), random)) << "pose " << i;
    }
  };
  expect_all_pass();
  pretest.Update(4.0);  // three quarters of everything: no cheaper than all
  expect_all_pass();
}

// The sample agrees with its own pose; that is no evidence.
TEST(Pretest, DoesNotCountTheSampleItself) {
  Random random = TestRandom();
  const Scene1300 scene(0, 1, random);
  Sample sample;
  for (std::uint32_t i = 0; i < scene.made.line_is_inlier.size(); ++i) {
    if (scene.made.line_is_inlier[i] != 0) sample.lines[sample.line_count++] = i;
  }
  ASSERT_EQ(sample.line_count, 1);
  Pretest pretest(scene.prepared, kOptions);
  pretest.Update(30.0);
  int with_sample = 0;
  int without = 0;
  for (int i = 0; i < 500; ++i) {
    Random same = random.Fork(static_cast<std::uint64_t>(i));
    Random again = same;
    without += pretest.Passes({}, scene.truth, same) ? 1 : 0;
    with_sample += pretest.Passes(sample, scene.truth, again) ? 1 : 0;
  }
  EXPECT_LT(with_sample, without);
}

}  // namespace
}  // namespace maploc::testing
