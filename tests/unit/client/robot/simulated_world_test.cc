#include "client/robot/simulated_world.h"

#include <bit>

#include <gtest/gtest.h>

#include "client/robot/simulated_map.h"
#include "client/robot/simulated_robot.h"
#include "mapstore/formats/colmap.h"
#include "mapstore/formats/line_tracks.h"
#include "mapstore/geometry/gravity.h"
#include "tests/support/files.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

int BitsApart(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  int bits = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    bits += std::popcount(static_cast<unsigned>(a[i] ^ b[i]));
  return bits;
}

MapInfo SomeMap() {
  MapInfo map;
  map.key = {"campus", 1};
  map.point_descriptor = *DescriptorKindFromName("orb");
  map.line_descriptor = *DescriptorKindFromName("lbd");
  return map;
}

TEST(SimulatedWorldTest, StretchesDifferInWhatStandsThere) {
  const World world = MakeCampus({});
  for (const WorldLine& line : world.lines) {
    EXPECT_EQ(line.kind == LandmarkKind::kWallLine, world.IsStructured(line.stretch));
  }
  EXPECT_EQ(world.StretchAt(-1.0), world.options.stretches - 1);
  EXPECT_EQ(world.StretchAt(world.LaneLength() + 1.0), 0);
}

TEST(SimulatedWorldTest, EverySiteHasItsOwnKinds) {
  const World world =
      MakeCampus({.sites = {Site::kHouses, Site::kTrees, Site::kSquare, Site::kConstruction}});
  ASSERT_EQ(world.options.stretches, 4);
  std::array<std::array<int, kLandmarkKinds>, 4> counts{};
  for (const WorldPoint& point : world.points)
    ++counts[point.stretch][static_cast<int>(point.kind)];
  for (const WorldLine& line : world.lines) ++counts[line.stretch][static_cast<int>(line.kind)];
  const auto count = [&](Site site, LandmarkKind kind) {
    return counts[static_cast<int>(site)][static_cast<int>(kind)];
  };
  EXPECT_GT(count(Site::kHouses, LandmarkKind::kWallLine), 100);
  EXPECT_EQ(count(Site::kHouses, LandmarkKind::kScaffoldLine), 0);
  EXPECT_EQ(count(Site::kTrees, LandmarkKind::kWallLine), 0);
  EXPECT_GT(count(Site::kTrees, LandmarkKind::kLeafPoint), 100);
  EXPECT_GT(count(Site::kSquare, LandmarkKind::kWallLine), 0);
  EXPECT_GT(count(Site::kSquare, LandmarkKind::kGroundPoint),
            count(Site::kHouses, LandmarkKind::kGroundPoint));
  EXPECT_GT(count(Site::kConstruction, LandmarkKind::kScaffoldLine), 30);
  EXPECT_EQ(count(Site::kConstruction, LandmarkKind::kWallLine), 0);
}

TEST(SimulatedRobotTest, ADayOfItsOwnTakesTheSeasonsPlace) {
  const World world = MakeCampus({});
  DriveOptions drive;
  drive.name = "fog";
  drive.appearance.emplace();
  drive.appearance->fill({.unseen = 1.0, .look_alike = 0.0, .flip = 0.0});
  drive.sight.clutter_points = drive.sight.clutter_lines = 0;
  const SimulatedRobot robot(world, drive, SomeMap());
  EXPECT_EQ(robot.QueryName(0), "fog/0000");
  EXPECT_TRUE(robot.MakeQuery(0)->views[0].points.keypoints_px.empty());
}

// A feature's ray, in the world, passes its landmark: projection, mounting and motion chain.
TEST(SimulatedWorldTest, FeaturesPointAtTheirLandmarks) {
  const World world = MakeCampus({});
  const Camera camera = SimulatedCamera();
  const Rigid3 world_from_body = WorldFromBody(world, 17.0, 0.4, 0.1, 0.02, -0.03);
  const Rigid3 camera_from_world = SimulatedCameraFromBody() * world_from_body.Inverse();
  Random random = testing::TestRandom();
  SightOptions exact;
  exact.noise_px = 0.0;
  const Sight sight =
      Look(world, camera, camera_from_world, AppearanceOf(Season::kSummer), exact, random);
  int seen = 0;
  for (std::size_t i = 0; i < sight.point_landmarks.size(); ++i) {
    if (sight.point_landmarks[i] < 0) continue;
    ++seen;
    const auto pixel =
        camera.Project(camera_from_world * world.points[sight.point_landmarks[i]].position);
    ASSERT_TRUE(pixel.has_value());
    EXPECT_LT((pixel->cast<float>() - sight.points.keypoints_px[i]).norm(), 1e-3f);
  }
  EXPECT_GT(seen, 20);
}

TEST(SimulatedWorldTest, AWallHidesWhatIsBehindIt) {
  World world;
  world.options.stretches = 2;
  world.radius_m = 100.0;
  world.walls.push_back({{5, -5}, {5, 5}, {-1, 0}, 6.0});
  world.points.push_back({{4, 0, 1}, LandmarkKind::kGroundPoint, 0, -1, {}});
  world.points.push_back({{8, 0, 1}, LandmarkKind::kGroundPoint, 0, -1, {}});
  // The camera looks along x from the origin: x right is -y, y down is -z.
  Eigen::Matrix3d camera_from_world;
  camera_from_world << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Rigid3 pose{Eigen::Quaterniond(camera_from_world), Eigen::Vector3d::Zero()};
  SightOptions options;
  options.clutter_points = options.clutter_lines = 0;
  bool near_seen = false;
  for (int repetition = 0; repetition < 20; ++repetition) {
    Random random = testing::TestRandom(repetition);
    const Sight sight =
        Look(world, SimulatedCamera(), pose, AppearanceOf(Season::kSummer), options, random);
    for (const int landmark : sight.point_landmarks) {
      EXPECT_EQ(landmark, 0);
      near_seen = true;
    }
  }
  EXPECT_TRUE(near_seen);
}

TEST(SimulatedWorldTest, WinterTakesLeavesAndLeavesWalls) {
  for (const LandmarkKind kind : {LandmarkKind::kLeafPoint, LandmarkKind::kWallLine}) {
    EXPECT_GT(ChangeOf(kind, Season::kWinter).look_alike,
              ChangeOf(kind, Season::kSummer).look_alike);
  }
  EXPECT_GT(ChangeOf(LandmarkKind::kLeafPoint, Season::kWinter).look_alike,
            2.0 * ChangeOf(LandmarkKind::kWallLine, Season::kWinter).look_alike);
}

TEST(SimulatedWorldTest, FlipsTheShareOfBitsThatIsAskedFor) {
  Random random = testing::TestRandom();
  int flipped = 0;
  constexpr int kRepetitions = 400;
  for (int i = 0; i < kRepetitions; ++i) {
    const BinaryDescriptor descriptor = RandomDescriptor(random);
    flipped += BitsApart(descriptor, Flipped(descriptor, 0.1, random));
  }
  EXPECT_NEAR(flipped / (256.0 * kRepetitions), 0.1, 0.01);
}

TEST(SimulatedRobotTest, TheSameQueryIsTheSameAndAnotherSeedIsNot) {
  const World world = MakeCampus({});
  DriveOptions drive;
  drive.queries = 3;
  const SimulatedRobot robot(world, drive, SomeMap());
  const Query query = *robot.MakeQuery(1);
  const Query again = *SimulatedRobot(world, drive, SomeMap()).MakeQuery(1);
  EXPECT_EQ(query.views[0].points.keypoints_px, again.views[0].points.keypoints_px);
  EXPECT_EQ(query.views[0].lines.descriptors.bytes, again.views[0].lines.descriptors.bytes);
  EXPECT_EQ(query.gravity->direction_in_body, again.gravity->direction_in_body);
  drive.seed = 2;
  const Query other = *SimulatedRobot(world, drive, SomeMap()).MakeQuery(1);
  EXPECT_NE(query.views[0].points.keypoints_px, other.views[0].points.keypoints_px);
}

TEST(SimulatedRobotTest, GravityIsInTheBodysFrame) {
  const World world = MakeCampus({});
  DriveOptions drive;
  drive.queries = 4;
  drive.gravity_noise_deg = 0.0;
  const SimulatedRobot robot(world, drive, SomeMap());
  for (int i = 0; i < robot.QueryCount(); ++i) {
    const Eigen::Quaterniond map_from_body = robot.ReferenceMapFromBody(i).rotation;
    EXPECT_LT(
        AngleBetween(map_from_body * robot.MakeQuery(i)->gravity->direction_in_body, kGravityInMap),
        1e-9);
  }
}

TEST(SimulatedRobotTest, SendsNoLinesToAMapWithoutLines) {
  const World world = MakeCampus({});
  MapInfo map = SomeMap();
  map.line_descriptor = {};
  EXPECT_EQ(SimulatedRobot(world, {}, map).MakeQuery(0)->views[0].lines.size(), 0);
}

TEST(SimulatedMapTest, WhatItWritesTheImportersReadersRead) {
  const testing::TemporaryFolder folder;
  const std::string& directory = folder.path();
  const World world = MakeCampus({.stretches = 2, .stretch_length_m = 30.0, .seed = 3});
  const Result<MappingSummary> summary = WriteMappingDrive(world, {}, directory);
  ASSERT_TRUE(summary.ok()) << summary.status().ToString();
  const auto model = ReadColmapModel(directory + "/model");
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  const auto features =
      ReadColmapDatabase(directory + "/database.db", DescriptorKindFromName("orb").value());
  ASSERT_TRUE(features.ok()) << features.status().ToString();
  const auto lines = ReadLineTracks(directory + "/lines.txt");
  ASSERT_TRUE(lines.ok()) << lines.status().ToString();
  EXPECT_EQ(static_cast<int>(model->points.size()), summary->points);
  EXPECT_EQ(static_cast<int>(lines->tracks.size()), summary->lines);
  EXPECT_GT(summary->points, 100);
  EXPECT_GT(summary->lines, 50);
  for (const auto& [id, point] : model->points) {
    for (const ColmapPoint::Observation& seen : point.track) {
      const ColmapImage& image = model->images.at(seen.image_id);
      const auto pixel =
          model->cameras.at(1).Project(image.camera_from_source * point.position_in_source);
      ASSERT_TRUE(pixel.has_value());
      // Noise of 0.7 px and 1 cm, seen from 1 m or more.
      EXPECT_LT((*pixel - image.keypoints_px[seen.keypoint]).norm(), 25.0);
    }
  }
  for (const LineTrack& track : lines->tracks) {
    for (const std::int64_t image : track.image_ids) EXPECT_TRUE(model->images.contains(image));
  }
}

}  // namespace
}  // namespace maploc
