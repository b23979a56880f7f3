// A fisheye and a 4K camera localize as a VGA pinhole does: the same features with the same noise
// of angle, on the whole way from COLMAP's files to an answer over the wire.
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/integration/any_camera/lens.h"
#include "tests/integration/any_camera/scores.h"
#include "tests/integration/any_camera/served_place.h"
#include "tests/support/seed.h"

namespace maploc::testing {
namespace {

// Level but for 20 degrees, near one of the spots that it was mapped from.
Rigid3 SomewhereInARoom(const Place& place, Random& random) {
  const auto spots = static_cast<std::uint32_t>(place.spots.size());
  const Eigen::Vector3d aside(random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3),
                              random.Uniform(-0.3, 0.3));
  const double pitch_rad = random.Uniform(-20, 20) * kRadPerDeg;
  return CameraFromMap(place.spots[random.Below(spots)] + place.unit_m * aside,
                       Eigen::Vector3d(0, std::cos(pitch_rad), std::sin(pitch_rad)),
                       random.Uniform(-std::numbers::pi, std::numbers::pi));
}

class AnyCameraTest : public ::testing::Test {
 protected:
  AnyCameraTest() : place_(MakeRooms(1.0, Eigen::Vector3d::Zero(), random_)) {}

  ServedPlace MappedThrough(const Lens& lens) const {
    return ServedPlace(place_, lens.camera, random_.Fork(1));
  }

  // The same sightings through each lens, and in every call.
  std::vector<Scores> Ask(const ServedPlace& served, const std::vector<Lens>& lenses,
                          const SightingOptions& options, int trials) const {
    Random random = random_;
    std::vector<Scores> scores;
    for (const Lens& lens : lenses) scores.emplace_back(lens.name, place_.unit_m);
    for (int i = 0; i < trials; ++i) {
      const Sighting sighting = See(place_, SomewhereInARoom(place_, random), options, random);
      for (std::size_t j = 0; j < lenses.size(); ++j) {
        const Eigen::Quaterniond turn = TurnOf(lenses[j], options.reach_rad, random);
        scores[j].Add(served.Ask(Through(sighting, lenses[j].camera, turn)),
                      sighting.BodyFromMap());
      }
    }
    for (const Scores& of_lens : scores) of_lens.Print();
    return scores;
  }

  Random random_ = TestRandom();
  const Place place_;
};

const std::vector<Lens> kLenses = {VgaPinhole(), Fisheye(120), Fisheye(150), Fisheye(180), FourK()};

void ExpectErrorsOf(const Scores& pinhole, const Scores& other) {
  EXPECT_GE(other.Localized(), 0.98) << other.name();
  EXPECT_EQ(other.Wrong(), 0.0) << other.name();
  EXPECT_LE(other.RotationRatio(pinhole), 1.02) << other.name();
  EXPECT_LE(other.PositionRatio(pinhole), 1.02) << other.name();
}

TEST_F(AnyCameraTest, ErrorsAreAPinholes) {
  const ServedPlace served = MappedThrough(VgaPinhole());
  const std::vector<Scores> scores = Ask(served, kLenses, {}, 400);
  for (const Scores& of_lens : scores) ExpectErrorsOf(scores[0], of_lens);
}

// Of 48 matches twelve are right: here and there too few for an answer.
TEST_F(AnyCameraTest, SuccessIsAPinholes) {
  const ServedPlace served = MappedThrough(VgaPinhole());
  SightingOptions options;
  options.most_points = 8;
  options.most_lines = 4;
  const std::vector<Scores> scores = Ask(served, kLenses, options, 600);
  EXPECT_LT(scores[0].Localized(), 0.98);
  for (const Scores& of_lens : scores) {
    EXPECT_NEAR(of_lens.Localized(), scores[0].Localized(), 0.02) << of_lens.name();
    EXPECT_EQ(of_lens.Wrong(), 0.0) << of_lens.name();
  }
}

// What the importer tells of a map that a fisheye made is as true as of a pinhole's.
TEST_F(AnyCameraTest, AFisheyeMapsAsAPinholeDoes) {
  const std::vector<Lens> lenses = {VgaPinhole(), Fisheye(180)};
  const std::vector<Scores> by_pinhole = Ask(MappedThrough(VgaPinhole()), lenses, {}, 200);
  const std::vector<Scores> by_fisheye = Ask(MappedThrough(Fisheye(180)), lenses, {}, 200);
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    ExpectErrorsOf(by_pinhole[i], by_fisheye[i]);
    EXPECT_NEAR(by_fisheye[i].MedianOverSigma(), by_pinhole[i].MedianOverSigma(), 0.1);
  }
}

// Also a coarse one, of 483 pixels from rim to rim.
TEST_F(AnyCameraTest, AFisheyeUsesAllThatItSees) {
  const ServedPlace served = MappedThrough(VgaPinhole());
  const Scores pinhole = Ask(served, {VgaPinhole()}, {}, 100).front();
  SightingOptions all_around;
  all_around.reach_rad = 89 * kRadPerDeg;
  all_around.most_points = 60;
  all_around.most_lines = 30;
  const std::vector<Scores> scores =
      Ask(served, {Fisheye(180), Fisheye(180, 150)}, all_around, 100);
  for (const Scores& of_lens : scores) {
    EXPECT_GE(of_lens.Localized(), 0.98) << of_lens.name();
    EXPECT_LT(of_lens.MedianRotationDeg(), 0.5 * pinhole.MedianRotationDeg());
    EXPECT_LT(of_lens.MedianPosition(), 0.5 * pinhole.MedianPosition());
  }
}

}  // namespace
}  // namespace maploc::testing
