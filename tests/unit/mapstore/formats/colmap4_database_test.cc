// Databases of COLMAP 4: its tables as it makes them, and learned features.
#include <cstring>
#include <random>

#include "tests/support/pose_priors.h"
#include "tests/unit/mapstore/formats/colmap_database_fixture.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

class Colmap4DatabaseTest : public testing::ColmapDatabaseTest {
 protected:
  Colmap4DatabaseTest() {
    Execute(
        "CREATE TABLE rigs (rig_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, ref_sensor_id "
        "INTEGER NOT NULL, ref_sensor_type INTEGER NOT NULL);"
        "CREATE TABLE rig_sensors (rig_id INTEGER NOT NULL, sensor_id INTEGER NOT NULL, "
        "sensor_type INTEGER NOT NULL, sensor_from_rig BLOB);"
        "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, model INTEGER "
        "NOT NULL, width INTEGER NOT NULL, height INTEGER NOT NULL, params BLOB, "
        "prior_focal_length INTEGER NOT NULL);"
        "CREATE TABLE frames (frame_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, rig_id INTEGER "
        "NOT NULL);"
        "CREATE TABLE frame_data (frame_id INTEGER NOT NULL, data_id INTEGER NOT NULL, sensor_id "
        "INTEGER NOT NULL, sensor_type INTEGER NOT NULL);"
        "CREATE TABLE images (image_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, name TEXT NOT "
        "NULL UNIQUE, camera_id INTEGER NOT NULL);"
        "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, "
        "cols INTEGER NOT NULL, data BLOB);"
        "CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, "
        "cols INTEGER NOT NULL, data BLOB, type INTEGER NOT NULL DEFAULT 0);"
        "PRAGMA user_version = 4000;"
        // Two cameras on one rig, one frame with both of its images, and cameras that maploc
        // cannot compute: the database's cameras are not read.
        "INSERT INTO rigs VALUES (1, 1, 0); INSERT INTO rig_sensors VALUES (1, 2, 0, zeroblob(56));"
        "INSERT INTO cameras VALUES (1, 17, 2000, 1000, zeroblob(16), 0);"
        "INSERT INTO frames VALUES (1, 1); INSERT INTO frame_data VALUES (1, 1, 1, 0), (1, 2, 2, "
        "0);");
  }
  // Image 1 with descriptors of `rows` unit vectors of `elements` float32.
  void AddLearned(const std::string& type, int rows, int elements) {
    std::mt19937 engine(3);
    std::normal_distribution<float> normal;
    std::vector<float> values;
    for (int row = 0; row < rows; ++row) {
      Eigen::VectorXf unit = Eigen::VectorXf::NullaryExpr(elements, [&] { return normal(engine); });
      unit.normalize();
      values.insert(values.end(), unit.begin(), unit.end());
    }
    AddImage(1, "left.jpg", std::vector<float>(static_cast<std::size_t>(2 * rows), 1.0f), 2, rows,
             4 * elements);
    Execute("UPDATE descriptors SET type = " + type +
            ", data = " + Hex(values.data(), values.size() * sizeof(float)));
  }
};

TEST_F(Colmap4DatabaseTest, SiftIsReadBesideRigsAndFrames) {
  AddImage(1, "left.jpg", {1, 2, 3, 4}, 2, 2, 128);
  AddImage(2, "right.jpg", {1, 2, 3, 4}, 2, 2, 128);
  const auto database = ReadColmapDatabase(path_);
  ASSERT_TRUE(database.ok()) << database.status().ToString();
  EXPECT_EQ(database->at("right.jpg").points.descriptors.kind.name, "sift_root_u8");
}

// Bits of float32 compared by Hamming would match nothing, and say so to nobody.
TEST_F(Colmap4DatabaseTest, LearnedFeaturesAreOfTheKindOfTheirLength) {
  for (const std::string type : {"2", "1", "9"}) {
    AddLearned(type, 30, 128);
    const auto database = ReadColmapDatabase(path_);
    ASSERT_TRUE(database.ok()) << database.status().ToString();
    const Descriptors& read = database->at("left.jpg").points.descriptors;
    EXPECT_EQ(read.kind, *DescriptorKindFromName("unit128"));
    EXPECT_EQ(read.size(), 30);
    EXPECT_TRUE(CheckScale(read, "read").ok());
    EXPECT_TRUE(ReadColmapDatabase(path_, *DescriptorKindFromName("unit128")).ok());
    for (const std::string other : {"binary512", "sift_root_u8", "unit64"}) {
      EXPECT_THAT(
          Error(*DescriptorKindFromName(other)),
          HasSubstr("has learned descriptors of kind unit128, but descriptors of kind " + other));
    }
    Execute("DELETE FROM images; DELETE FROM keypoints; DELETE FROM descriptors;");
  }
}

// Other programs write learned features without a type: SuperPoint has 256 elements, DISK 128.
TEST_F(Colmap4DatabaseTest, LearnedFeaturesWithoutATypeAreKnownByTheirBytes) {
  for (const auto& [type, elements] : {std::pair("0", 128), std::pair("-1", 256)}) {
    AddLearned(type, 30, elements);
    const auto database = ReadColmapDatabase(path_);
    ASSERT_TRUE(database.ok()) << database.status().ToString();
    EXPECT_EQ(database->at("left.jpg").points.descriptors.kind.bytes, elements);
    Execute("DELETE FROM images; DELETE FROM keypoints; DELETE FROM descriptors;");
  }
}

TEST_F(Colmap4DatabaseTest, WhatIsNoLearnedDescriptorIsToldByItsRow) {
  AddLearned("2", 30, 128);
  Execute("UPDATE descriptors SET data = zeroblob(30 * 512)");
  EXPECT_THAT(Error(), HasSubstr("image 1 ('left.jpg'): holds ALIKED_N32: "));
  EXPECT_THAT(Error(), HasSubstr("row 0 is not finite or has no length"));
  Execute("UPDATE descriptors SET cols = 130, data = zeroblob(30 * 130)");
  EXPECT_THAT(Error(), HasSubstr("its rows of 130 bytes are no float32"));
  Execute("UPDATE descriptors SET cols = 32, data = zeroblob(30 * 32)");
  EXPECT_THAT(Error(), HasSubstr("'unit8' is unknown"));
}

TEST_F(Colmap4DatabaseTest, AnImageInWhichNothingWasLearnedHasNoFeatures) {
  AddLearned("2", 30, 128);
  AddImage(2, "right.jpg", {}, 2, 0, 0);
  Execute("UPDATE descriptors SET type = 2");
  const auto database = ReadColmapDatabase(path_);
  ASSERT_TRUE(database.ok()) << database.status().ToString();
  EXPECT_EQ(database->at("right.jpg").points.descriptors.size(), 0);
  EXPECT_EQ(database->at("left.jpg").points.descriptors.size(), 30);
}

// One program's SIFT and another's learned features in one database.
TEST_F(Colmap4DatabaseTest, LearnedAndOtherFeaturesTogetherAreRefused) {
  AddLearned("2", 30, 128);
  AddImage(2, "right.jpg", {1, 2, 3, 4}, 2, 2, 128);
  EXPECT_THAT(Error(), HasSubstr("image 2 ('right.jpg'): has no learned descriptors, but "
                                 "descriptors of kind unit128"));
}

TEST_F(Colmap4DatabaseTest, PriorsOfPositionAloneBreakNothing) {
  AddImage(1, "left.jpg", {1, 2}, 2, 1, 128);
  ColmapModel model;
  model.images[1] = {1, 1, "left.jpg", {}, {}, {}};
  testing::AddPosePriors(path_, model, {{"left.jpg", {0, 1, 0}}});
  Execute("UPDATE pose_priors SET position = zeroblob(24), position_covariance = zeroblob(72)");
  EXPECT_EQ(ReadColmapGravity(path_)->size(), 1u);
  for (const std::string none : {"NULL", "x''"}) {
    Execute("UPDATE pose_priors SET gravity = " + none);
    const auto gravity = ReadColmapGravity(path_);
    ASSERT_TRUE(gravity.ok()) << gravity.status().ToString();
    EXPECT_TRUE(gravity->empty());
  }
}

}  // namespace
}  // namespace maploc
