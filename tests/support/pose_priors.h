// COLMAP 4's table pose_priors, written into a database that lacks it.
#pragma once

#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "mapstore/formats/colmap.h"

namespace maploc::testing {

inline void ExecuteSql(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  char* error = nullptr;
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
  sqlite3_free(error);
  sqlite3_close(database);
}

inline std::string DoublesAsSql(const Eigen::Vector3d& values) {
  std::string hex = "x'";
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  for (std::size_t i = 0; i < 3 * sizeof(double); ++i) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    hex += {kDigits[bytes[i] >> 4], kDigits[bytes[i] & 15]};
  }
  return hex + "'";
}

// `gravity_in_camera` by image name; an image without it gets COLMAP's NaN.
inline void AddPosePriors(const std::string& path, const ColmapModel& model,
                          const std::map<std::string, Eigen::Vector3d>& gravity_in_camera) {
  std::string sql =
      "CREATE TABLE pose_priors (pose_prior_id INTEGER PRIMARY KEY NOT NULL, corr_data_id INTEGER "
      "NOT NULL, corr_sensor_id INTEGER NOT NULL, corr_sensor_type INTEGER NOT NULL, position "
      "BLOB, position_covariance BLOB, gravity BLOB, coordinate_system INTEGER NOT NULL);";
  for (const auto& [id, image] : model.images) {
    const auto found = gravity_in_camera.find(image.name);
    const Eigen::Vector3d gravity =
        found == gravity_in_camera.end() ? Eigen::Vector3d::Constant(NAN) : found->second;
    sql +=
        "INSERT INTO pose_priors (corr_data_id, corr_sensor_id, corr_sensor_type, gravity, "
        "coordinate_system) VALUES (" +
        std::to_string(id) + ", " + std::to_string(image.camera_id) + ", 0, " +
        DoublesAsSql(gravity) + ", -1);";
  }
  ExecuteSql(path, sql);
}

}  // namespace maploc::testing
