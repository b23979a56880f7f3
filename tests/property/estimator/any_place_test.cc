// Neither does it matter how the camera is held, how large the map is, or where its origin lies.
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mapstore/geometry/gravity.h"
#include "tests/property/estimator/answers.h"
#include "tests/support/seed.h"

namespace maploc::testing {
namespace {

constexpr int kTrials = 500;
constexpr double kGravitySigmaRad = 0.5 * kDegree;

SyntheticProblem MakeScene(Random& random) {
  SyntheticOptions options;
  options.point_inliers = options.line_inliers = 12;
  options.point_outliers = options.line_outliers = 36;
  options.gravity_noise_rad = options.gravity_sigma_rad = kGravitySigmaRad;
  return MakeSyntheticProblem(options, random);
}

// The same scene, map and camera turned together until gravity points to `gravity_in_camera`.
SyntheticProblem HeldSo(const Eigen::Vector3d& gravity_in_camera, SyntheticProblem made,
                        Random& random) {
  const Eigen::Quaterniond held =
      CameraFromAligned(gravity_in_camera) *
      Eigen::Quaterniond(Eigen::AngleAxisd(random.Uniform(-3.14, 3.14), Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond turn = held.conjugate() * made.camera_from_map.rotation;
  for (auto& point : made.problem.points) point.position_in_map = turn * point.position_in_map;
  for (auto& line : made.problem.lines) {
    line.segment_in_map.start = turn * line.segment_in_map.start;
    line.segment_in_map.end = turn * line.segment_in_map.end;
  }
  made.camera_from_map.rotation = held;
  made.problem.gravity_in_camera =
      NoisyGravityInCamera(made.camera_from_map, kGravitySigmaRad, random);
  return made;
}

SyntheticProblem Scaled(double unit, SyntheticProblem made) {
  for (auto& point : made.problem.points) point.position_in_map *= unit;
  for (auto& line : made.problem.lines) {
    line.segment_in_map.start *= unit;
    line.segment_in_map.end *= unit;
  }
  made.camera_from_map.translation *= unit;
  return made;
}

Answer EstimateMade(const SyntheticProblem& made, std::uint64_t seed, double unit = 1.0) {
  return Estimate(made.problem, made.camera_from_map, VgaPinhole(), seed, unit);
}

struct Held {
  std::string name;
  Eigen::Vector3d gravity_in_camera;
};

void PrintTo(const Held& held, std::ostream* out) { *out << held.name; }

class AnyAttitude : public ::testing::TestWithParam<Held> {};

TEST_P(AnyAttitude, IsFound) {
  Random random = TestRandom();
  std::vector<Answer> level;
  std::vector<Answer> held;
  for (int i = 0; i < kTrials; ++i) {
    const SyntheticProblem made = MakeScene(random);
    const std::uint64_t seed = random.Next();
    level.push_back(EstimateMade(made, seed));
    held.push_back(EstimateMade(HeldSo(GetParam().gravity_in_camera, made, random), seed));
  }
  const Summary expected = Summarize("level", level);
  const Summary found = Summarize(GetParam().name.c_str(), held);
  EXPECT_GE(found.right, expected.right - 0.02);
  EXPECT_GE(found.localized, expected.localized - 0.05);
}

INSTANTIATE_TEST_SUITE_P(Held, AnyAttitude,
                         ::testing::Values(Held{"straight down", {0, 0, 1}},
                                           Held{"straight up", {0, 0, -1}},
                                           Held{"upside down", {0, -1, 0}},
                                           Held{"on its side", {1, 0, 0}}));

// A cube of two units, and a camera four away: a centimetre, a kilometre.
TEST(AnyPlace, AMapOfACentimetreAndOneOfAKilometreAreAlike) {
  Random random = TestRandom();
  std::vector<Answer> plain;
  std::vector<Answer> small;
  std::vector<Answer> large;
  for (int i = 0; i < kTrials; ++i) {
    const SyntheticProblem made = MakeScene(random);
    const std::uint64_t seed = random.Next();
    plain.push_back(EstimateMade(made, seed));
    small.push_back(EstimateMade(Scaled(0.005, made), seed, 0.005));
    large.push_back(EstimateMade(Scaled(500, made), seed, 500));
  }
  const Summary expected = Summarize("two metres", plain);
  for (const Summary& found : {Summarize("a centimetre", small), Summarize("a kilometre", large)}) {
    EXPECT_NEAR(found.right, expected.right, 0.01);
    EXPECT_NEAR(found.localized, expected.localized, 0.01);
    EXPECT_NEAR(found.position, expected.position, 0.02 * expected.position);
    EXPECT_NEAR(found.rotation_rad, expected.rotation_rad, 0.02 * expected.rotation_rad);
  }
}

TEST(AnyPlace, AMapFarFromTheOriginIsLocalizedAsWell) {
  Random random = TestRandom();
  std::vector<Answer> near;
  std::vector<Answer> far;
  for (int i = 0; i < kTrials; ++i) {
    const SyntheticProblem made = MakeScene(random);
    const std::uint64_t seed = random.Next();
    near.push_back(EstimateMade(made, seed));
    far.push_back(EstimateMade(MovedBy(500e3 * RandomDirection(random), made), seed));
  }
  const Summary expected = Summarize("at the origin", near);
  const Summary found = Summarize("500 km away", far);
  EXPECT_NEAR(found.right, expected.right, 0.01);
  EXPECT_NEAR(found.localized, expected.localized, 0.01);
  EXPECT_NEAR(found.position, expected.position, 0.02 * expected.position);
  EXPECT_NEAR(found.rotation_rad, expected.rotation_rad, 0.02 * expected.rotation_rad);
}

}  // namespace
}  // namespace maploc::testing
