// A COLMAP database made with SQL, whose path needs escaping, and its errors.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "mapstore/formats/colmap.h"
#include "tests/support/files.h"

namespace maploc::testing {

class ColmapDatabaseTest : public ::testing::Test {
 protected:
  ColmapDatabaseTest() : path_(folder_.File("data base#1?.db")) {}

  void Execute(const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
    char* error = nullptr;
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
    sqlite3_close(database);
  }
  void MakeTables() {
    Execute(
        "CREATE TABLE images (image_id INTEGER PRIMARY KEY, name TEXT, camera_id INTEGER);"
        "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data "
        "BLOB);"
        "CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY, rows INTEGER, cols INTEGER, data "
        "BLOB);");
  }
  static std::string Hex(const void* data, std::size_t size) {
    std::string hex = "x'";
    for (std::size_t i = 0; i < size; ++i) {
      char digits[3];
      std::snprintf(digits, sizeof(digits), "%02x", static_cast<const unsigned char*>(data)[i]);
      hex += digits;
    }
    return hex + "'";
  }
  // Descriptors of the id, but for each row's first byte.
  void AddImage(int id, const std::string& name, const std::vector<float>& keypoints, int cols,
                int descriptor_rows, int descriptor_cols) {
    std::vector<unsigned char> descriptors(
        static_cast<std::size_t>(descriptor_rows * descriptor_cols),
        static_cast<unsigned char>(id));
    for (int row = 0; row < descriptor_rows; ++row) {
      descriptors[static_cast<std::size_t>(row * descriptor_cols)] =
          static_cast<unsigned char>(row + 101);
    }
    const int rows = cols == 0 ? 0 : static_cast<int>(keypoints.size()) / cols;
    const std::string key = std::to_string(id);
    Execute("INSERT INTO images (image_id, name, camera_id) VALUES (" + key + ", '" + name +
            "', 1);" + "INSERT INTO keypoints VALUES (" + key + ", " + std::to_string(rows) + ", " +
            std::to_string(cols) + ", " + Hex(keypoints.data(), keypoints.size() * 4) + ");" +
            "INSERT INTO descriptors (image_id, rows, cols, data) VALUES (" + key + ", " +
            std::to_string(descriptor_rows) + ", " + std::to_string(descriptor_cols) + ", " +
            Hex(descriptors.data(), descriptors.size()) + ");");
  }
  std::string Error(const std::optional<DescriptorKind>& kind = std::nullopt) {
    const auto database = ReadColmapDatabase(path_, kind);
    if (database.ok()) return "read";
    EXPECT_THAT(database.status().message(), ::testing::HasSubstr(path_));
    return database.status().message();
  }

  TemporaryFolder folder_;
  std::string path_;
};

}  // namespace maploc::testing
