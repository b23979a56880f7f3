// The lens makes no difference: the same scene from the same place, seen with the same noise of
// angle, gives the same answers through a VGA pinhole, fisheyes of 120, 150 and 180 degrees (the
// scene anywhere from the middle to the rim), one of finer pixels, and a 4K camera: RANSAC,
// refinement and judgement.
#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/solvers/reprojection.h"
#include "tests/property/estimator/answers.h"
#include "tests/support/seed.h"
#include "tests/support/seen_through.h"

namespace maploc::testing {
namespace {

constexpr double kFocalPx = 500.0;
constexpr int kTrials = 1500;
constexpr double kSceneRadius = 29.5 * kDegree;  // of the part of the pinhole's image that is used

struct Lens {
  std::string name;
  Camera camera;
  double degrees = 0;  // from rim to rim; 0: the scene stays in the middle
};

void PrintTo(const Lens& lens, std::ostream* out) { *out << lens.name; }

Lens FisheyeLens(double degrees) {
  return {"fisheye of " + std::to_string(static_cast<int>(degrees)) + " degrees",
          FisheyeOf(degrees, kFocalPx), degrees};
}

// Three times as many pixels a radian: thresholds are as many pixels more.
Lens FineFisheye() { return {"fine fisheye of 150 degrees", FisheyeOf(150, 3.0 * kFocalPx), 150}; }

Lens FourK() {
  const double focal_px = kFocalPx * std::hypot(3840, 2160) / 800;
  return {
      "4K",
      Camera::Create(CameraModel::kPinhole, 3840, 2160, {focal_px, focal_px, 1920, 1080}).value()};
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

// Up to `room` off the axis, in any direction.
Eigen::Quaterniond RandomTurn(double room, Random& random) {
  const double around = random.Uniform(0, 2 * std::numbers::pi);
  const Eigen::Vector3d axis(std::cos(around), std::sin(around), 0);
  return Eigen::Quaterniond(Eigen::AngleAxisd(random.Uniform(0, room), axis));
}

// Of the true point matches, how many agree with the true pose.
class TrueMatches {
 public:
  void Add(const PoseProblem& problem, const Rigid3& truth,
           const std::vector<std::uint8_t>& is_inlier) {
    ASSERT_EQ(problem.points.size(), is_inlier.size());
    const InlierFlags flags =
        FindInliers(problem, truth, RansacOptions().max_reprojection_error_px);
    for (std::size_t i = 0; i < is_inlier.size(); ++i) {
      all_ += is_inlier[i];
      agree_ += is_inlier[i] != 0 && flags.points[i] != 0 ? 1 : 0;
    }
  }
  double share() const { return static_cast<double>(agree_) / all_; }

 private:
  int all_ = 0;
  int agree_ = 0;
};

class AnyCamera : public ::testing::TestWithParam<Lens> {};

TEST_P(AnyCamera, AnswersAsAPinholeDoes) {
  Random random = TestRandom();
  const Lens& lens = GetParam();
  const double room = std::max(0.5 * lens.degrees * kDegree - kSceneRadius, 0.0);
  std::vector<Answer> by_pinhole;
  std::vector<Answer> by_lens;
  TrueMatches of_pinhole;
  TrueMatches of_lens;
  for (int i = 0; i < kTrials; ++i) {
    const SyntheticProblem made = MakeScene(random);
    const Eigen::Quaterniond turn = RandomTurn(room, random);
    const Rigid3 turned = {turn * made.camera_from_map.rotation,
                           turn * made.camera_from_map.translation};
    const PoseProblem seen = SeenThrough(lens.camera, turn, made.problem);
    const std::uint64_t seed = random.Next();
    of_pinhole.Add(made.problem, made.camera_from_map, made.point_is_inlier);
    of_lens.Add(seen, turned, made.point_is_inlier);
    by_pinhole.push_back(Estimate(made.problem, made.camera_from_map, VgaPinhole(), seed));
    by_lens.push_back(Estimate(seen, turned, lens.camera, seed));
  }
  const Summary pinhole = Summarize("VGA pinhole", by_pinhole);
  const Summary other = Summarize(lens.name.c_str(), by_lens);
  std::printf("true matches kept: %.4f, %.4f\n", of_pinhole.share(), of_lens.share());
  EXPECT_GE(other.right, pinhole.right - 0.02);
  EXPECT_GE(other.localized, pinhole.localized - 0.02);
  EXPECT_LE(other.rotation_rad, 1.02 * pinhole.rotation_rad);
  EXPECT_LE(other.position, 1.02 * pinhole.position);
  EXPECT_GE(of_lens.share(), of_pinhole.share() - 0.005);
}

INSTANTIATE_TEST_SUITE_P(Lenses, AnyCamera,
                         ::testing::Values(FisheyeLens(120), FisheyeLens(150), FisheyeLens(180),
                                           FineFisheye(), FourK()));

}  // namespace
}  // namespace maploc::testing
