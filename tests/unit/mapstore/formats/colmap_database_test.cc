#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/pose_priors.h"
#include "tests/support/seed.h"
#include "tests/unit/mapstore/formats/colmap_database_fixture.h"

namespace maploc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using ColmapDatabaseTest = testing::ColmapDatabaseTest;

TEST_F(ColmapDatabaseTest, ReadsKeypointsOfTwoFourAndSixColumnsInOurPixels) {
  MakeTables();
  AddImage(1, "two.jpg", {1.5, 2.5, 3.5, 4.5}, 2, 2, 128);
  AddImage(2, "four.jpg", {1.5, 2.5, 9, 9, 3.5, 4.5, 9, 9}, 4, 2, 128);
  AddImage(3, "six.jpg", {1.5, 2.5, 9, 9, 9, 9, 3.5, 4.5, 9, 9, 9, 9}, 6, 2, 128);
  Execute("INSERT INTO images VALUES (4, 'none.jpg', 1)");
  const auto database = ReadColmapDatabase(path_);
  ASSERT_TRUE(database.ok()) << database.status().ToString();
  ASSERT_EQ(database->size(), 4u);
  for (const char* name : {"two.jpg", "four.jpg", "six.jpg"}) {
    const ColmapFeatures& features = database->at(name);
    EXPECT_THAT(features.points.keypoints_px,
                ElementsAre(Eigen::Vector2f(1, 2), Eigen::Vector2f(3, 4)));
    EXPECT_EQ(features.points.descriptors.kind.name, "sift_root_u8");
    EXPECT_EQ(features.points.descriptors.size(), 2);
    EXPECT_EQ(features.points.descriptors.row(1)[127], features.image_id);
  }
  EXPECT_TRUE(database->at("none.jpg").points.keypoints_px.empty());
}

TEST_F(ColmapDatabaseTest, TheKindIsGuessedFromTheColumnsUnlessItIsGiven) {
  MakeTables();
  AddImage(1, "a.jpg", {1, 2}, 2, 1, 48);
  EXPECT_EQ(ReadColmapDatabase(path_)->at("a.jpg").points.descriptors.kind.name, "binary48");
  EXPECT_THAT(Error(*DescriptorKindFromName("orb")),
              ::testing::AllOf(HasSubstr("descriptors of kind orb have 32"),
                               HasSubstr("leave --descriptors out")));
  AddImage(2, "b.jpg", {1, 2}, 2, 1, 32);
  EXPECT_THAT(Error(), HasSubstr("image 2 ('b.jpg'): has 32 columns"));
}

TEST_F(ColmapDatabaseTest, LeavesNothingBesideTheFile) {
  MakeTables();
  Execute("PRAGMA journal_mode = WAL");
  AddImage(1, "a.jpg", {1, 2}, 2, 1, 128);
  const auto before = std::filesystem::last_write_time(path_);
  std::filesystem::permissions(path_, std::filesystem::perms::owner_read);
  ASSERT_TRUE(ReadColmapDatabase(path_).ok());
  EXPECT_EQ(std::filesystem::last_write_time(path_), before);
  EXPECT_FALSE(std::filesystem::exists(path_ + "-wal"));
  EXPECT_FALSE(std::filesystem::exists(path_ + "-shm"));
}

TEST_F(ColmapDatabaseTest, ADatabaseThatIsBeingWrittenIsRefused) {
  MakeTables();
  folder_.Write("data base#1?.db-wal", "pages");
  EXPECT_THAT(Error(), HasSubstr("write-ahead log"));
  folder_.Write("data base#1?.db", "");  // all that was written is in the log still
  EXPECT_THAT(Error(), HasSubstr("write-ahead log"));
}

// A program that died in a transaction: pages of its unfinished change are in the file already, and
// the journal beside it holds what they were. SQLite made both.
TEST_F(ColmapDatabaseTest, WhatACrashLeftHalfWrittenIsRefused) {
  MakeTables();
  for (int id = 1; id <= 40; ++id) {
    AddImage(id, std::to_string(id) + ".jpg", std::vector<float>(40, 1.0f), 2, 20, 128);
  }
  sqlite3* writer = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &writer), SQLITE_OK);
  const char* change =
      "PRAGMA cache_size = 2; BEGIN; UPDATE descriptors SET data = zeroblob(length(data));";
  ASSERT_EQ(sqlite3_exec(writer, change, nullptr, nullptr, nullptr), SQLITE_OK);
  const std::string half_written = testing::ReadFile(path_);
  const std::string journal = testing::ReadFile(path_ + "-journal");
  sqlite3_exec(writer, "ROLLBACK", nullptr, nullptr, nullptr);
  sqlite3_close(writer);
  ASSERT_NE(half_written, testing::ReadFile(path_)) << "the change never reached the file";

  testing::WriteFile(path_, half_written);
  testing::WriteFile(path_ + "-journal", journal);
  EXPECT_THAT(Error(), HasSubstr("has a rollback journal beside it"));
  EXPECT_THAT(ReadColmapGravity(path_).status().message(), HasSubstr("rollback journal"));
  const std::string link = folder_.File("link.db");
  std::filesystem::create_symlink(path_, link);
  EXPECT_THAT(ReadColmapDatabase(link).status().message(), HasSubstr("rollback journal"));

  Execute("PRAGMA integrity_check");  // the cure that the message names
  const auto database = ReadColmapDatabase(path_);
  ASSERT_TRUE(database.ok()) << database.status().ToString();
  for (const auto& [name, features] : *database) {
    EXPECT_EQ(features.points.descriptors.row(0)[5], features.image_id) << name;
  }
}

// journal_mode PERSIST and TRUNCATE leave a journal whose transaction is done.
TEST_F(ColmapDatabaseTest, AJournalThatIsDoneWithIsNoHindrance) {
  for (const std::string mode : {"PERSIST", "TRUNCATE"}) {
    std::filesystem::remove(path_);
    MakeTables();
    Execute("PRAGMA journal_mode = " + mode + "; INSERT INTO images VALUES (1, 'a.jpg', 1)");
    ASSERT_TRUE(std::filesystem::exists(path_ + "-journal"));
    EXPECT_EQ(Error(), "read") << mode;
  }
}

TEST_F(ColmapDatabaseTest, RefusesDescriptorsThatDescribeNothing) {
  MakeTables();
  AddImage(1, "good.jpg", std::vector<float>(40, 1.0f), 2, 20, 128);
  AddImage(2, "bad.jpg", std::vector<float>(40, 1.0f), 2, 20, 128);
  ASSERT_EQ(Error(), "read");
  Execute("UPDATE descriptors SET data = zeroblob(length(data)) WHERE image_id = 2");
  EXPECT_THAT(Error(), HasSubstr("image 2 ('bad.jpg'): 20 of its 20 descriptors are one byte"));
  const std::vector<unsigned char> sevens(20 * 128, 7);
  const std::string where = " WHERE image_id = 2";
  Execute("UPDATE descriptors SET data = " + Hex(sevens.data(), sevens.size()) + where);
  EXPECT_THAT(Error(), HasSubstr("'bad.jpg'"));
  std::vector<unsigned char> equal(20 * 128, 7);
  for (std::size_t i = 0; i < equal.size(); i += 2) equal[i] = 9;
  Execute("UPDATE descriptors SET data = " + Hex(equal.data(), equal.size()) + where);
  EXPECT_THAT(Error(), HasSubstr("its 20 descriptors are all equal; extract"));
}

TEST_F(ColmapDatabaseTest, ThirtyThousandKeypointsOfAPhotoAreRead) {
  MakeTables();
  AddImage(1, "a.jpg", std::vector<float>(60000, 1.0f), 2, 30000, 128);
  const auto database = ReadColmapDatabase(path_);
  ASSERT_TRUE(database.ok()) << database.status().ToString();
  EXPECT_EQ(database->at("a.jpg").points.keypoints_px.size(), 30000u);
  EXPECT_EQ(database->at("a.jpg").points.descriptors.size(), 30000);
  EXPECT_EQ(database->at("a.jpg").points.descriptors.row(29999)[127], 1);
}

TEST_F(ColmapDatabaseTest, RefusesRowsThatDisagree) {
  MakeTables();
  AddImage(1, "a.jpg", {1, 2, 3, 4}, 2, 1, 128);
  EXPECT_THAT(Error(), HasSubstr("has 1 rows, but there are 2 keypoints"));
  Execute("UPDATE descriptors SET rows = 2");
  EXPECT_THAT(Error(), HasSubstr("its data has 128 bytes, rows and cols say 256"));
  Execute("UPDATE descriptors SET rows = -1");
  EXPECT_THAT(Error(), HasSubstr("out of range"));
  Execute("UPDATE descriptors SET rows = 9223372036854775807, cols = 9223372036854775807");
  EXPECT_THAT(Error(), HasSubstr("out of range"));
  Execute("UPDATE keypoints SET data = NULL");
  EXPECT_THAT(Error(), HasSubstr("its data has 0 bytes"));
}

// COLMAP 4's columns; three images, of which one has gravity (unscaled), one NaN, one no row.
TEST_F(ColmapDatabaseTest, GravityIsReadWhereItWasMeasured) {
  MakeTables();
  ColmapModel model;
  for (const int id : {1, 2, 3}) {
    const std::string name = std::string(1, static_cast<char>('a' + id - 1)) + ".jpg";
    AddImage(id, name, {1, 2}, 2, 1, 128);
    if (id < 3) model.images[id] = {id, 1, name, {}, {}, {}};
  }
  EXPECT_TRUE(ReadColmapGravity(path_)->empty()) << "a database without the table";
  testing::AddPosePriors(path_, model, {{"a.jpg", {0, 9.81, 0}}});
  Execute(
      "INSERT INTO pose_priors (corr_data_id, corr_sensor_id, corr_sensor_type, gravity, "
      "coordinate_system) VALUES (3, 1, 1, x'00', 0)");  // an IMU's data, not image 3's
  const auto gravity = ReadColmapGravity(path_);
  ASSERT_TRUE(gravity.ok()) << gravity.status().ToString();
  ASSERT_EQ(gravity->size(), 1u);
  EXPECT_LT((gravity->at("a.jpg") - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
}

TEST_F(ColmapDatabaseTest, AnEarlierTableOfPriorsHasNoGravity) {
  MakeTables();
  Execute(
      "CREATE TABLE pose_priors (image_id INTEGER PRIMARY KEY NOT NULL, position BLOB, "
      "coordinate_system INTEGER NOT NULL, position_covariance BLOB);"
      "INSERT INTO pose_priors VALUES (1, NULL, 0, NULL)");
  const auto gravity = ReadColmapGravity(path_);
  ASSERT_TRUE(gravity.ok()) << gravity.status().ToString();
  EXPECT_TRUE(gravity->empty());
}

TEST_F(ColmapDatabaseTest, RefusesGravityThatIsNoDirection) {
  MakeTables();
  AddImage(1, "a.jpg", {1, 2}, 2, 1, 128);
  ColmapModel model;
  model.images[1] = {1, 1, "a.jpg", {}, {}, {}};
  testing::AddPosePriors(path_, model, {{"a.jpg", {0, 0, 0}}});
  EXPECT_THAT(ReadColmapGravity(path_).status().message(),
              HasSubstr("table pose_priors, image 1 ('a.jpg'): its gravity is no direction"));
  Execute("UPDATE pose_priors SET gravity = " + testing::DoublesAsSql({0, 1e200, 0}));
  EXPECT_EQ(ReadColmapGravity(path_)->at("a.jpg"), Eigen::Vector3d(0, 1, 0));
  Execute("UPDATE pose_priors SET gravity = x'0011'");
  EXPECT_THAT(ReadColmapGravity(path_).status().message(), HasSubstr("not three float64"));
}

TEST_F(ColmapDatabaseTest, RefusesKeypointsThatAreNotPositions) {
  MakeTables();
  AddImage(1, "a.jpg", {1, 2, 3}, 3, 1, 128);
  EXPECT_THAT(Error(), HasSubstr("cols is 3, not 2, 4 or 6"));
  Execute("DELETE FROM images; DELETE FROM keypoints; DELETE FROM descriptors");
  AddImage(2, "b.jpg", {1, std::numeric_limits<float>::quiet_NaN()}, 2, 1, 128);
  EXPECT_THAT(Error(), HasSubstr("image 2 ('b.jpg'): keypoint 0 is not finite"));
}

TEST_F(ColmapDatabaseTest, RefusesTwoImagesOfOneName) {
  MakeTables();
  AddImage(1, "a.jpg", {1, 2}, 2, 1, 128);
  AddImage(2, "a.jpg", {1, 2}, 2, 1, 128);
  EXPECT_THAT(Error(), HasSubstr("'a.jpg' stands twice"));
}

TEST_F(ColmapDatabaseTest, RefusesOtherFiles) {
  EXPECT_EQ(ReadColmapDatabase(path_).status().code(), StatusCode::kNotFound);
  folder_.Write("data base#1?.db", std::string(5000, 'x'));
  EXPECT_THAT(Error(), HasSubstr("is not an SQLite database"));
  std::filesystem::remove(path_);
  Execute("CREATE TABLE other (x)");
  EXPECT_THAT(Error(), HasSubstr("is not a COLMAP database"));
}

TEST_F(ColmapDatabaseTest, EveryTruncationIsRefused) {
  MakeTables();
  AddImage(1, "a.jpg", std::vector<float>(400, 1.0f), 2, 200, 128);
  const std::string whole = folder_.Read("data base#1?.db");
  for (std::size_t length = 0; length < whole.size(); length += 97) {
    folder_.Write("data base#1?.db", whole.substr(0, length));
    EXPECT_NE(Error(), "read") << length;
  }
}

TEST_F(ColmapDatabaseTest, NoDamageCrashesIt) {
  MakeTables();
  AddImage(1, "a.jpg", std::vector<float>(400, 1.0f), 2, 200, 128);
  const std::string whole = folder_.Read("data base#1?.db");
  Random random = testing::TestRandom();
  for (int i = 0; i < 200; ++i) {
    std::string damaged = whole;
    for (int flips = 0; flips < 8; ++flips) {
      damaged[random.Below(static_cast<std::uint32_t>(damaged.size()))] =
          static_cast<char>(random.Below(256));
    }
    folder_.Write("data base#1?.db", damaged);
    const auto database = ReadColmapDatabase(path_);
    if (!database.ok()) continue;
    for (const auto& [name, features] : *database) {
      EXPECT_EQ(features.points.keypoints_px.size(),
                static_cast<std::size_t>(features.points.descriptors.size()));
    }
  }
}

}  // namespace
}  // namespace maploc
