#include "mapstore/formats/colmap_writer.h"

#include <gtest/gtest.h>

#include "tests/support/files.h"

namespace maploc {
namespace {

class ColmapWriterTest : public ::testing::Test {
 protected:
  ColmapWriterTest() {
    model_.cameras.emplace(
        3, *Camera::Create(CameraModel::kRadial, 640, 480, {500, 320.25, 240, 0.1, -0.01}));
    ColmapImage image;
    image.id = 7;
    image.camera_id = 3;
    image.name = "a/b c.png";
    image.camera_from_source = {Eigen::Quaterniond(0.1, 0.7, -0.3, 0.6).normalized(), {1, 2, 1e-7}};
    image.keypoints_px = {{0, 0}, {12.5, 470.125}};
    image.point_ids = {-1, 11};
    model_.images.emplace(7, image);
    model_.points.emplace(11, ColmapPoint{11, {0.1, 1.0 / 3.0, -5}, 0.25, {{7, 1}}});
  }

  testing::TemporaryFolder folder_;
  ColmapModel model_;
};

TEST_F(ColmapWriterTest, AModelComesBackAsItWas) {
  ASSERT_TRUE(WriteColmapModel(folder_.path(), model_).ok());
  const Result<ColmapModel> read = ReadColmapModel(folder_.path());
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  EXPECT_EQ(read->cameras.at(3).params(), model_.cameras.at(3).params());
  const ColmapImage& image = read->images.at(7);
  EXPECT_EQ(image.name, "a/b c.png");
  EXPECT_EQ(image.keypoints_px, model_.images.at(7).keypoints_px);
  EXPECT_EQ(image.point_ids, model_.images.at(7).point_ids);
  EXPECT_LT(RotationAngleBetween(image.camera_from_source.rotation,
                                 model_.images.at(7).camera_from_source.rotation),
            1e-12);
  EXPECT_EQ(read->points.at(11).position_in_source, model_.points.at(11).position_in_source);
  EXPECT_EQ(read->points.at(11).track.at(0).keypoint, 1);
}

TEST_F(ColmapWriterTest, ADatabaseComesBackAsItWasAndReplacesAnOlder) {
  PointFeatures points;
  points.keypoints_px = {{0, 0}, {12.5f, 470.125f}};
  points.descriptors.kind = *DescriptorKindFromName("binary3");
  points.descriptors.bytes = {1, 2, 3, 4, 5, 6};
  const std::string path = folder_.File("database.db");
  for (int repetition = 0; repetition < 2; ++repetition) {
    ASSERT_TRUE(WriteColmapDatabase(path, model_, {{"a/b c.png", points}}).ok());
  }
  const auto read = ReadColmapDatabase(path);
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  ASSERT_EQ(read->size(), 1u);
  EXPECT_EQ(read->at("a/b c.png").image_id, 7);
  EXPECT_EQ(read->at("a/b c.png").points.keypoints_px, points.keypoints_px);
  EXPECT_EQ(read->at("a/b c.png").points.descriptors.bytes, points.descriptors.bytes);
}

TEST_F(ColmapWriterTest, APlaceThatCannotBeWrittenIsAnError) {
  const std::string missing = folder_.File("no/such/database.db");
  EXPECT_EQ(WriteColmapDatabase(missing, model_, {}).reason(), "WRITE_FAILED");
}

}  // namespace
}  // namespace maploc
