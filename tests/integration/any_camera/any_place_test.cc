// Neither does it matter how the camera is held, how large the map is, or where its origin lies:
// each on the whole way from COLMAP's files to an answer over the wire.
#include <cmath>
#include <numbers>

#include "tests/integration/any_camera/lens.h"
#include "tests/integration/any_camera/scores.h"
#include "tests/integration/any_camera/served_place.h"
#include "tests/support/seed.h"

namespace maploc::testing {
namespace {

constexpr int kTrials = 150;
constexpr double kFieldDepth = 15.0;  // the drone's height

// Held so that it measures `gravity`, within 5 degrees, near one of the mapping drive's spots.
Rigid3 HeldNearASpot(const Place& place, const Eigen::Vector3d& gravity, double aside,
                     Random& random) {
  const auto spots = static_cast<std::uint32_t>(place.spots.size());
  const auto within = [&](double most) {
    return Eigen::Vector3d(random.Uniform(-most, most), random.Uniform(-most, most),
                           random.Uniform(-most, most));
  };
  return CameraFromMap(place.spots[random.Below(spots)] + place.unit_m * within(aside),
                       gravity + within(0.05), random.Uniform(-std::numbers::pi, std::numbers::pi));
}

const Eigen::Vector3d kLevel(0, 1, 0);

struct Held {
  std::string name;
  Eigen::Vector3d gravity;
  double aside = 0.3;  // from a spot, units
  double depth = 1.0;  // what errors are told in, units
  SightingOptions options = {};
};

// Asked through a VGA pinhole, which also mapped the place.
Scores AskHeld(const Place& place, const ServedPlace& served, const Held& held, Random& random) {
  Scores scores(held.name, place.unit_m * held.depth);
  for (int i = 0; i < kTrials; ++i) {
    const Rigid3 camera_from_map = HeldNearASpot(place, held.gravity, held.aside, random);
    const Sighting sighting = See(place, camera_from_map, held.options, random);
    const Query query = Through(sighting, VgaPinhole().camera, Eigen::Quaterniond::Identity());
    scores.Add(served.Ask(query), sighting.BodyFromMap());
  }
  scores.Print();
  return scores;
}

Scores AskInRooms(double unit_m, const Eigen::Vector3d& origin, const std::string& name,
                  const Eigen::Vector3d& gravity, Random random) {
  const Place place = MakeRooms(unit_m, origin, random);
  const ServedPlace served(place, VgaPinhole().camera, random);
  return AskHeld(place, served, {name, gravity}, random);
}

void ExpectRight(const Scores& scores) {
  EXPECT_GE(scores.Localized(), 0.98) << scores.name();
  EXPECT_EQ(scores.Wrong(), 0.0) << scores.name();
}

// Flat ground gives tilt and shift apart by little: the whole image is needed.
TEST(AnyPlaceTest, ADroneLooksStraightDown) {
  Random random = TestRandom();
  const Place place = MakeField(random);
  const ServedPlace served(place, VgaPinhole().camera, random);
  Held drone{"a drone, straight down", Eigen::Vector3d::UnitZ(), 2.0, kFieldDepth};
  drone.options.reach_rad = 24 * kRadPerDeg;
  drone.options.most_points = 24;
  ExpectRight(AskHeld(place, served, drone, random));
}

TEST(AnyPlaceTest, TheCameraHangsUpsideDown) {
  Random random = TestRandom();
  const Scores level = AskInRooms(1.0, Eigen::Vector3d::Zero(), "level", kLevel, random);
  const Scores hanging = AskInRooms(1.0, Eigen::Vector3d::Zero(), "upside down", -kLevel, random);
  ExpectRight(level);
  ExpectRight(hanging);
  EXPECT_LE(hanging.MedianPosition(), 1.2 * level.MedianPosition());
  EXPECT_LE(hanging.MedianRotationDeg(), 1.2 * level.MedianRotationDeg());
}

struct Where {
  std::string name;
  double unit_m;
  Eigen::Vector3d origin;
};

// The very same rooms and sightings, made smaller, larger or moved: the same answers. A map that is
// 60 units long; as far as UTM's coordinates go.
TEST(AnyPlaceTest, NeitherSizeNorOriginMatters) {
  const Random random = TestRandom();
  const Scores plain = AskInRooms(1.0, Eigen::Vector3d::Zero(), "60 metres", kLevel, random);
  ExpectRight(plain);
  for (const auto& [name, unit_m, origin] :
       {Where{"a centimetre", 0.01 / 70, {0, 0, 0}}, Where{"a kilometre", 1000.0 / 70, {0, 0, 0}},
        Where{"5400 km from the origin", 1.0, {450e3, 5.4e6, 250}},
        Where{"a centimetre, 100 m away", 0.01 / 70, {-60, 80, 3}}}) {
    const Scores scores = AskInRooms(unit_m, origin, name, kLevel, random);
    ExpectRight(scores);
    EXPECT_EQ(scores.Localized(), plain.Localized()) << name;
    EXPECT_NEAR(scores.MedianPosition(), plain.MedianPosition(), 0.02 * plain.MedianPosition());
    EXPECT_NEAR(scores.MedianRotationDeg(), plain.MedianRotationDeg(),
                0.02 * plain.MedianRotationDeg());
    EXPECT_NEAR(scores.MedianOverSigma(), plain.MedianOverSigma(), 0.02) << name;
  }
}

}  // namespace
}  // namespace maploc::testing
