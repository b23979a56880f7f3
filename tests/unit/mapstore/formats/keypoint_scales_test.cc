// The scales of COLMAP's keypoints, in each of its three layouts.
#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "mapstore/formats/colmap.h"
#include "tests/support/files.h"

namespace maploc::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// One image with two keypoints of `cols` columns each.
std::vector<float> Scales(const std::vector<float>& keypoints, int cols) {
  const TemporaryFolder folder;
  sqlite3* database = nullptr;
  sqlite3_open(folder.File("database.db").c_str(), &database);
  sqlite3_exec(database,
               "CREATE TABLE images (image_id INTEGER, name TEXT);"
               "CREATE TABLE keypoints (image_id INTEGER, rows INTEGER, cols INTEGER, data BLOB);"
               "CREATE TABLE descriptors (image_id INTEGER, rows INTEGER, cols INTEGER, data BLOB);"
               "INSERT INTO images VALUES (1, 'a');"
               "INSERT INTO descriptors VALUES (1, 2, 32, zeroblob(64));",
               nullptr, nullptr, nullptr);
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO keypoints VALUES (1, 2, ?, ?)", -1, &insert, nullptr);
  sqlite3_bind_int(insert, 1, cols);
  sqlite3_bind_blob(insert, 2, keypoints.data(), static_cast<int>(keypoints.size() * sizeof(float)),
                    SQLITE_STATIC);
  EXPECT_EQ(sqlite3_step(insert), SQLITE_DONE);
  sqlite3_finalize(insert);
  sqlite3_close(database);
  const auto features = ReadColmapDatabase(folder.File("database.db"));
  EXPECT_TRUE(features.ok()) << features.status().ToString();
  return features.ok() ? features->at("a").scales_px : std::vector<float>{-1.0f};
}

TEST(KeypointScalesTest, EachLayoutHasItsOwn) {
  EXPECT_THAT(Scales({1, 2, 3, 4}, 2), IsEmpty());
  EXPECT_THAT(Scales({1, 2, 2.5f, 0.1f, 1, 2, 7, 0.2f}, 4), ElementsAre(2.5f, 7.0f));
  // A turn by 90 degrees and twice the size; axes of 3 and 5.
  EXPECT_THAT(Scales({1, 2, 0, -2, 2, 0, 1, 2, 3, 0, 0, 5}, 6), ElementsAre(2.0f, 4.0f));
  EXPECT_THAT(Scales({1, 2, std::nanf(""), 0, 1, 2, 7, 0}, 4), ElementsAre(0.0f, 7.0f));
}

}  // namespace
}  // namespace maploc::testing
