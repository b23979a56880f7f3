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
TEST_F(Colmap4DatabaseTest, LearnedFeaturesAreRefusedByName) {
  AddLearned("2", 30, 128);
  EXPECT_THAT(Error(), HasSubstr("table descriptors, image 1 ('left.jpg'): holds ALIKED_N32"));
  EXPECT_THAT(Error(), HasSubstr("--FeatureExtraction.type SIFT"));
  EXPECT_THAT(Error(*DescriptorKindFromName("binary512")), HasSubstr("ALIKED_N32"));
  Execute("UPDATE descriptors SET type = 1");
  EXPECT_THAT(Error(), HasSubstr("holds ALIKED_N16ROT"));
  Execute("UPDATE descriptors SET type = 9");
  EXPECT_THAT(Error(), HasSubstr("holds features of type 9"));
}

// Other programs write learned features without a type: SuperPoint has 256 elements, DISK 128.
TEST_F(Colmap4DatabaseTest, LearnedFeaturesWithoutATypeAreNoticedByTheirBytes) {
  AddLearned("0", 30, 128);
  EXPECT_THAT(Error(), HasSubstr("its descriptors are 128 float32 each"));
  Execute("UPDATE descriptors SET type = -1");
  EXPECT_THAT(Error(), HasSubstr("its descriptors are 128 float32 each"));
  Execute("DELETE FROM images; DELETE FROM keypoints; DELETE FROM descriptors;");
  AddLearned("0", 30, 256);
  EXPECT_THAT(Error(), HasSubstr("its descriptors are 256 float32 each"));
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
