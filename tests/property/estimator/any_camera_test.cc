// The lens makes no difference: the same scene from the same place, seen with the same noise of
// angle, gives the same answers through a VGA pinhole, fisheyes of 120, 150 and 180 degrees (the
// scene anywhere from the middle to the rim) and a 4K camera: RANSAC, refinement and judgement.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>

#include "mapstore/base/median.h"
#include "server/ransac/estimator.h"
#include "server/refinement/refine.h"
#include "server/solvers/reprojection.h"
#include "server/trust/judge.h"
#include "tests/support/seed.h"
#include "tests/support/seen_through.h"

namespace maploc::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kFocalPx = 500.0;
constexpr int kTrials = 1500;
constexpr double kSceneRadius = 29.5 * kDegree;  // of the part of the pinhole's image that is used

struct Lens {
  const char* name;
  Camera camera;
  double degrees;  // from rim to rim
};

void PrintTo(const Lens& lens, std::ostream* out) { *out << lens.name; }

Camera Pinhole(int width_px, int height_px, double focal_px) {
  return Camera::Create(CameraModel::kPinhole, width_px, height_px,
                        {focal_px, focal_px, 0.5 * width_px, 0.5 * height_px})
      .value();
}

// A square of 400 pixels of the pinhole's image, 75% wrong matches, half a degree of gravity noise;
// one pixel of noise, as an angle.
SyntheticProblem MakeScene(Random& random) {
  SyntheticOptions options;
  options.point_inliers = options.line_inliers = 12;
  options.point_outliers = options.line_outliers = 36;
  options.noise_px = 0.0;
  options.gravity_noise_rad = options.gravity_sigma_rad = 0.5 * kDegree;
  options.focal_length_px = kFocalPx;
  options.image_width_px = options.image_height_px = 400;
  SyntheticProblem made = MakeSyntheticProblem(options, random);
  AddAngularNoise(1.0 / kFocalPx, random, &made.problem);
  return made;
}

struct Answer {
  bool right = false;  // within 1.5 degrees and 0.15 m of a camera 3 to 5 metres away
  bool localized = false;
  double true_share = 0.0;  // of the true point matches that agree with the true pose
  PoseError error;
};

double TrueShare(const PoseProblem& problem, const Rigid3& truth,
                 const std::vector<std::uint8_t>& is_inlier) {
  const InlierFlags flags = FindInliers(problem, truth, 4.0);
  int agree = 0;
  int all = 0;
  for (std::size_t i = 0; i < is_inlier.size(); ++i) {
    all += is_inlier[i];
    agree += is_inlier[i] != 0 && flags.points[i] != 0 ? 1 : 0;
  }
  return static_cast<double>(agree) / all;
}

Answer Estimate(const SyntheticProblem& made, const Camera& camera, const Eigen::Quaterniond& turn,
                std::uint64_t seed) {
  const PoseProblem problem = SeenThrough(camera, turn, made.problem);
  const Rigid3 truth = {turn * made.camera_from_map.rotation,
                        turn * made.camera_from_map.translation};
  Answer answer;
  if (problem.points.size() != made.problem.points.size()) return answer;
  answer.true_share = TrueShare(problem, truth, made.point_is_inlier);
  RansacOptions options;
  options.seed = seed;
  options.max_iterations = 300;
  const Consensus consensus = EstimateConsensus(problem, options);
  if (!consensus.found) return answer;
  const RefinedPose pose = RefinePose(problem, consensus.camera_from_map, {});
  answer.error = ComparePoses(pose.camera_from_map, truth);
  answer.right = answer.error.rotation_rad < 1.5 * kDegree && answer.error.position < 0.15;
  JudgeOptions judge;
  judge.iterations = consensus.iterations;
  answer.localized = JudgePose(problem, pose, camera, judge).outcome == Outcome::kLocalized;
  return answer;
}

struct Summary {
  double right = 0.0;
  double localized = 0.0;
  double true_share = 0.0;
  double rotation_rad = 0.0;
  double position = 0.0;
};

Summary Summarize(const std::vector<Answer>& answers) {
  Summary summary;
  std::vector<double> rotations;
  std::vector<double> positions;
  for (const Answer& answer : answers) {
    summary.right += answer.right ? 1 : 0;
    summary.localized += answer.localized ? 1 : 0;
    summary.true_share += answer.true_share;
    rotations.push_back(answer.right ? answer.error.rotation_rad : 1e9);
    positions.push_back(answer.right ? answer.error.position : 1e9);
  }
  const double count = static_cast<double>(answers.size());
  summary.right /= count;
  summary.localized /= count;
  summary.true_share /= count;
  summary.rotation_rad = Median(rotations);
  summary.position = Median(positions);
  std::printf("right %.3f, localized %.3f, true matches %.4f, median %.3f deg %.4f\n",
              summary.right, summary.localized, summary.true_share, summary.rotation_rad / kDegree,
              summary.position);
  return summary;
}

class AnyCamera : public ::testing::TestWithParam<Lens> {};

TEST_P(AnyCamera, AnswersAsAPinholeDoes) {
  Random random = TestRandom();
  const Camera pinhole = Pinhole(640, 480, kFocalPx);
  std::vector<Answer> by_pinhole;
  std::vector<Answer> by_lens;
  const double room = std::max(0.5 * GetParam().degrees * kDegree - kSceneRadius, 0.0);
  for (int i = 0; i < kTrials; ++i) {
    const SyntheticProblem made = MakeScene(random);
    const Eigen::Vector3d axis =
        Eigen::AngleAxisd(random.Uniform(0, 2 * std::numbers::pi), Eigen::Vector3d::UnitZ()) *
        Eigen::Vector3d::UnitX();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(random.Uniform(0, room), axis));
    const std::uint64_t seed = random.Next();
    by_pinhole.push_back(Estimate(made, pinhole, Eigen::Quaterniond::Identity(), seed));
    by_lens.push_back(Estimate(made, GetParam().camera, turn, seed));
  }
  const Summary pinholes = Summarize(by_pinhole);
  const Summary lenses = Summarize(by_lens);
  EXPECT_GE(lenses.right, pinholes.right - 0.02);
  EXPECT_GE(lenses.localized, pinholes.localized - 0.02);
  EXPECT_GE(lenses.true_share, pinholes.true_share - 0.01);
  EXPECT_LE(lenses.rotation_rad, 1.02 * pinholes.rotation_rad);
  EXPECT_LE(lenses.position, 1.02 * pinholes.position);
}

INSTANTIATE_TEST_SUITE_P(
    Lenses, AnyCamera,
    ::testing::Values(Lens{"fisheye of 120 degrees", FisheyeOf(120, kFocalPx), 120},
                      Lens{"fisheye of 150 degrees", FisheyeOf(150, kFocalPx), 150},
                      Lens{"fisheye of 180 degrees", FisheyeOf(180, kFocalPx), 180},
                      Lens{"4K", Pinhole(3840, 2160, kFocalPx* std::hypot(3840, 2160) / 800), 0}));

}  // namespace
}  // namespace maploc::testing
