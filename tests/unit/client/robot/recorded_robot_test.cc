#include "client/robot/recorded_robot.h"

#include <chrono>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/robot/metrics.h"
#include "mapstore/formats/colmap_writer.h"
#include "tests/integration/tools/facade_model.h"
#include "tests/support/files.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

// Two images of one camera, "b" written before "a", with two keypoints of 32 binary bytes each.
class RecordedRobotTest : public ::testing::Test {
 protected:
  RecordedRobotTest() {
    model_.cameras.emplace(1, *Camera::Create(CameraModel::kPinhole, 64, 48, {50, 50, 32, 24}));
    AddImage(1, "b", {0, 0, 4});
    AddImage(2, "a", {0, 0, 8});
    model_.points.emplace(5, ColmapPoint{5, {0, 0, 2}, 0.1, {{2, 0}}});
    model_.images.at(2).keypoints_px = {{32, 24}};
    model_.images.at(2).point_ids = {5};
    EXPECT_TRUE(WriteColmapModel(folder_.path(), model_).ok());
    EXPECT_TRUE(WriteColmapDatabase(folder_.File("database.db"), model_,
                                    {{"a", Features(32)}, {"b", Features(32)}})
                    .ok());
    map_.key = {"yard", 1};
    map_.point_descriptor = *DescriptorKindFromName("binary32");
    options_.model_dir = folder_.path();
    options_.database = folder_.File("database.db");
  }

  void AddImage(std::int64_t id, const std::string& name, const Eigen::Vector3d& translation) {
    ColmapImage image;
    image.id = id;
    image.camera_id = 1;
    image.name = name;
    image.camera_from_source.translation = translation;
    model_.images.emplace(id, image);
  }
  static PointFeatures Features(int bytes) {
    PointFeatures points;
    points.keypoints_px = {{1, 2}, {3, 4}};
    points.descriptors.kind = *DescriptorKindFromName("binary" + std::to_string(bytes));
    points.descriptors.bytes.assign(static_cast<std::size_t>(2 * bytes), 7);
    return points;
  }
  RecordedRobot Open() {
    Result<RecordedRobot> robot = RecordedRobot::Open(options_, map_);
    EXPECT_TRUE(robot.ok()) << robot.status().ToString();
    return *std::move(robot);
  }

  testing::TemporaryFolder folder_;
  ColmapModel model_;
  MapInfo map_;
  RecordingOptions options_;
};

TEST_F(RecordedRobotTest, AsksInTheOrderOfNamesAndSendsNothingOfTheReference) {
  const RecordedRobot robot = Open();
  ASSERT_EQ(robot.QueryCount(), 2);
  EXPECT_EQ(robot.QueryName(0), "a");
  const Result<Query> query = robot.MakeQuery(0);
  ASSERT_TRUE(query.ok()) << query.status().ToString();
  EXPECT_EQ(query->map, "yard");
  EXPECT_FALSE(query->prior.has_value());
  EXPECT_TRUE(query->gravity.has_value());
  ASSERT_EQ(query->views.size(), 1u);
  EXPECT_EQ(query->views[0].points.keypoints_px.size(), 2u);
  EXPECT_EQ(query->views[0].lines.size(), 0);
}

TEST_F(RecordedRobotTest, SendsNoGravityWhereNoneIsAskedFor) {
  options_.gravity.none = true;
  EXPECT_FALSE(Open().MakeQuery(0)->gravity.has_value());
}

TEST_F(RecordedRobotTest, ComparesInTheMapsFrame) {
  map_.map_from_source = {
      2.0, Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 2) / 3)), {5, 6, 7}};
  const RecordedRobot robot = Open();
  // Image "b" stands at (0, 0, -4) in the source's frame.
  const Rigid3 reference = robot.ReferenceMapFromBody(1);
  EXPECT_LT((reference.translation - map_.map_from_source * Eigen::Vector3d(0, 0, -4)).norm(),
            1e-9);
  EXPECT_LT(RotationAngleBetween(reference.rotation, map_.map_from_source.rotation), 1e-9);
}

TEST_F(RecordedRobotTest, KnowsTheScenesDepthInTheMapsUnitWhereItHasPoints) {
  map_.map_from_source.scale = 3.0;
  const RecordedRobot robot = Open();
  ASSERT_TRUE(robot.SceneDepth(0).has_value());
  EXPECT_DOUBLE_EQ(*robot.SceneDepth(0), 30.0);
  EXPECT_FALSE(robot.SceneDepth(1).has_value());
}

TEST_F(RecordedRobotTest, ABinaryDatabaseTakesTheMapsNameForItsLength) {
  map_.point_descriptor = *DescriptorKindFromName("orb");
  EXPECT_EQ(Open().MakeQuery(0)->views[0].points.descriptors.kind.name, "orb");
}

TEST_F(RecordedRobotTest, RefusesADatabaseOfAnotherKindThanTheMaps) {
  map_.point_descriptor = *DescriptorKindFromName("sift_root_u8");
  const Status status = RecordedRobot::Open(options_, map_).status();
  EXPECT_EQ(status.reason(), "DESCRIPTOR_KIND_MISMATCH");
  EXPECT_THAT(status.message(), HasSubstr("binary32"));
  EXPECT_THAT(status.message(), HasSubstr("database.db"));
}

TEST_F(RecordedRobotTest, SendsNoPointsToAMapWithoutPoints) {
  map_.point_descriptor = {};
  EXPECT_TRUE(Open().MakeQuery(0)->views[0].points.keypoints_px.empty());
}

TEST_F(RecordedRobotTest, NamesTheImageThatTheDatabaseLacks) {
  ASSERT_TRUE(WriteColmapDatabase(folder_.File("database.db"), model_, {{"a", Features(32)}}).ok());
  const Result<RecordedRobot> robot = RecordedRobot::Open(options_, map_);
  // The image is known to the database, but without features: nothing to send, and no fault.
  ASSERT_TRUE(robot.ok());
  EXPECT_TRUE(robot->MakeQuery(1)->views[0].points.keypoints_px.empty());
  model_.images.erase(1);
  ASSERT_TRUE(WriteColmapDatabase(folder_.File("database.db"), model_, {{"a", Features(32)}}).ok());
  EXPECT_THAT(RecordedRobot::Open(options_, map_).status().message(),
              HasSubstr("1 of 2 images have no row in it: 'b'"));
}

TEST_F(RecordedRobotTest, NeedsFeaturesFromSomewhere) {
  options_.database.clear();
  EXPECT_EQ(RecordedRobot::Open(options_, map_).status().code(), StatusCode::kInvalidArgument);
}

// Before any session begins, and of all images at once.
TEST_F(RecordedRobotTest, TellsHowManyPhotosAreMissingAndWhereTheyWereLookedFor) {
  options_.database.clear();
  options_.images = folder_.File("photos");
  map_.point_descriptor = *DescriptorKindFromName("orb");
  const std::string none = RecordedRobot::Open(options_, map_).status().message();
  EXPECT_THAT(none, HasSubstr("photos: 2 of 2 images have no photo in it: 'a', 'b'"));
  std::filesystem::create_directory(options_.images);
  folder_.Write("photos/a", "P5 64 48 255\n" + std::string(64 * 48, '\x80'));
  EXPECT_THAT(RecordedRobot::Open(options_, map_).status().message(),
              HasSubstr("1 of 2 images have no photo in it: 'b'"));
  folder_.Write("photos/b", testing::ReadFile(folder_.File("photos/a")));
  EXPECT_TRUE(Open().MakeQuery(1).ok());
}

// A phone's gravity may be of the photo as it is shown.
TEST_F(RecordedRobotTest, SaysThatMeasuredGravityMustBeOfTheStoredPixels) {
  options_.images = folder_.path();
  map_.line_descriptor = *DescriptorKindFromName("lbd");
  const std::string exif("Exif\0\0MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0", 28);
  const std::string jpeg = "\xff\xd8\xff\xe1" + std::string("\0\x1e", 2) + exif +
                           std::string("\xff\xc0\0\x08\x08\0\x30\0\x40\x01\xff\xd9", 12);
  folder_.Write("a", jpeg);
  folder_.Write("b", "P5 64 48 255\n" + std::string(64 * 48, '\x80'));
  EXPECT_TRUE(Open().Notes().empty());
  folder_.Write("gravity.csv", "a,0,1,0\nb,0,1,0\n");
  options_.gravity.csv = folder_.File("gravity.csv");
  const RecordedRobot robot = Open();
  ASSERT_EQ(robot.Notes().size(), 1u);
  EXPECT_THAT(robot.Notes()[0], HasSubstr("1 of 2 photos have an EXIF orientation"));
}

// Photos that no query needs are not asked for.
TEST_F(RecordedRobotTest, PhotosAreNotNeededWhereTheMapHasNoLinesAndTheDatabaseThePoints) {
  options_.images = folder_.File("photos");
  EXPECT_TRUE(Open().MakeQuery(0).ok());
  map_.line_descriptor = *DescriptorKindFromName("binary32");
  EXPECT_FALSE(RecordedRobot::Open(options_, map_).ok());
}

TEST_F(RecordedRobotTest, APhotoOfAnotherSizeIsNoticedByItsHeader) {
  options_.database.clear();
  options_.images = folder_.path();
  map_.point_descriptor = *DescriptorKindFromName("orb");
  const std::string png = std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x30\0\0\0\x40", 24);
  folder_.Write("a", png);
  folder_.Write("b", png);
  EXPECT_THAT(RecordedRobot::Open(options_, map_).status().message(), HasSubstr("a: is 48x64"));
}

// The decoder would fill them up with grey, or fail in the middle of a session.
TEST_F(RecordedRobotTest, CutPhotosAreNamedAndRefusedBeforeAnySession) {
  options_.database.clear();
  options_.images = folder_.path();
  map_.point_descriptor = *DescriptorKindFromName("orb");
  const std::string frame("\xff\xd8\xff\xc0\0\x08\x08\0\x30\0\x40\x01", 12);
  folder_.Write("a", frame + "\xff\xd9");
  folder_.Write("b", frame);
  const Status status = RecordedRobot::Open(options_, map_).status();
  EXPECT_EQ(status.reason(), "TRUNCATED_IMAGE");
  EXPECT_THAT(status.message(), HasSubstr("1 of 2 photos are truncated"));
  EXPECT_THAT(status.message(), HasSubstr("'b'; copy them again"));
  folder_.Write("b", frame + "\xff\xd9 and a phone's video");
  EXPECT_TRUE(RecordedRobot::Open(options_, map_).ok());
}

TEST_F(RecordedRobotTest, TellsWhichFormOfAModelWasRead) {
  ASSERT_TRUE(WriteColmapModel(folder_.path(), model_).ok());
  EXPECT_TRUE(Open().Notes().empty());
  testing::WriteBinaryModel(folder_.path(), model_);
  const auto older = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
    std::filesystem::last_write_time(folder_.File(name), older);
  }
  const RecordedRobot robot = Open();
  ASSERT_EQ(robot.Notes().size(), 1u);
  EXPECT_THAT(robot.Notes()[0], HasSubstr(".bin files were read"));
}

TEST_F(RecordedRobotTest, TellsOnceThatPhotosAreLarge) {
  model_.cameras.at(1) =
      *Camera::Create(CameraModel::kPinhole, 6000, 4000, {5000, 5000, 3000, 2000});
  ASSERT_TRUE(WriteColmapModel(folder_.path(), model_).ok());
  EXPECT_TRUE(Open().Notes().empty()) << "no photo is looked at";
  options_.images = folder_.path();
  map_.line_descriptor = *DescriptorKindFromName("lbd");
  folder_.Write("a", "P5 6000 4000 255\n");
  folder_.Write("b", "P5 6000 4000 255\n");
  const RecordedRobot robot = Open();
  ASSERT_EQ(robot.Notes().size(), 1u);
  EXPECT_THAT(robot.Notes()[0], HasSubstr("2 of 2 photos are large"));
  EXPECT_THAT(robot.Notes()[0], HasSubstr("6000x4000 at 2400x1600"));
}

TEST_F(RecordedRobotTest, RefusesAMapWhoseKindNoDetectorMakes) {
  options_.database.clear();
  options_.images = folder_.path();
  EXPECT_EQ(RecordedRobot::Open(options_, map_).status().reason(), "NO_DETECTOR");
}

TEST_F(RecordedRobotTest, TellsHowManyRowsOfGravityAreMissing) {
  folder_.Write("gravity.csv", "b,0,9.81,0\n");
  options_.gravity.csv = folder_.File("gravity.csv");
  const Status status = RecordedRobot::Open(options_, map_).status();
  EXPECT_EQ(status.reason(), "NO_GRAVITY");
  EXPECT_THAT(status.message(), HasSubstr("1 of 2 images have no gravity in"));
  EXPECT_THAT(status.message(), HasSubstr("gravity.csv: 'a'; add a row"));
  folder_.Write("gravity.csv", "a,0,1,0\nb,0,9.81,0\n");
  EXPECT_EQ(Open().MakeQuery(1)->gravity->direction_in_body, Eigen::Vector3d(0, 1, 0));
}

TEST_F(RecordedRobotTest, RefusesANameThatCannotBeSent) {
  for (const std::string& name : {std::string("caf\xe9.jpg"), std::string(129, 'n')}) {
    ColmapModel model = model_;
    model.images.at(1).name = name;
    const testing::TemporaryFolder folder;
    ASSERT_TRUE(WriteColmapModel(folder.path(), model).ok());
    options_.model_dir = folder.path();
    EXPECT_THAT(RecordedRobot::Open(options_, map_).status().message(),
                HasSubstr("name of image 1: is "));
  }
}

TEST_F(RecordedRobotTest, SendsNoMorePointsThanAskedForAndSaysSo) {
  EXPECT_TRUE(Open().Notes().empty());
  options_.max_features = 1;
  const RecordedRobot robot = Open();
  EXPECT_EQ(robot.MakeQuery(0)->views[0].points.keypoints_px.size(), 1u);
  ASSERT_EQ(robot.Notes().size(), 1u);
  EXPECT_THAT(robot.Notes()[0], HasSubstr("2 of 2 images have more than 1 points"));
  for (const int bad : {0, -1, 20001}) {
    options_.max_features = bad;
    EXPECT_THAT(RecordedRobot::Open(options_, map_).status().message(),
                HasSubstr("--max-features"));
  }
}

// Root-SIFT of plain SIFT x, turned back, is x at OpenCV's scale up to rounding.
TEST(ConvertToKindTest, PlainSiftComesBackFromRootSift) {
  std::vector<double> plain(128);
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < 128; ++i) {
    plain[i] = (i * 37) % 50;
    sum += plain[i];
    squares += plain[i] * plain[i];
  }
  PointFeatures points;
  points.keypoints_px = {{0, 0}};
  points.descriptors.kind = *DescriptorKindFromName("sift_root_u8");
  for (const double x : plain) {
    points.descriptors.bytes.push_back(
        static_cast<std::uint8_t>(std::lround(512.0 * std::sqrt(x / sum))));
  }
  const Result<PointFeatures> converted = ConvertToKind(points, *DescriptorKindFromName("sift_u8"));
  ASSERT_TRUE(converted.ok());
  EXPECT_EQ(converted->descriptors.kind.name, "sift_u8");
  for (int i = 0; i < 128; ++i) {
    EXPECT_NEAR(converted->descriptors.bytes[i], 512.0 * plain[i] / std::sqrt(squares), 2.0) << i;
  }
}

}  // namespace
}  // namespace maploc
