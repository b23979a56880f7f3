#include <array>
#include <cmath>
#include <cstring>

#include "mapstore/formats/colmap.h"
#include "mapstore/formats/sqlite_colmap_file.h"

namespace maploc {
namespace {

// COLMAP 4's columns: a prior is of a sensor's data, and of a camera's (type 0) the data is the
// image. Earlier versions have another table of this name, without gravity.
constexpr const char* kColumns = "'corr_data_id', 'corr_sensor_type', 'gravity'";
constexpr const char* kQuery =
    "SELECT i.image_id, i.name, p.gravity FROM pose_priors p JOIN images i ON i.image_id = "
    "p.corr_data_id WHERE p.corr_sensor_type = 0 AND length(p.gravity) > 0 ORDER BY i.image_id";

// NaN where COLMAP has none.
Result<Eigen::Vector3d> ReadDirection(const SqliteColmapFile& file, sqlite3_stmt* row) {
  const auto error = [&](const char* what) {
    const auto* name = reinterpret_cast<const char*>(sqlite3_column_text(row, 1));
    return file.RowError("pose_priors", sqlite3_column_int64(row, 0), name, what);
  };
  std::array<double, 3> values;
  const void* const blob = sqlite3_column_blob(row, 2);
  if (blob == nullptr || sqlite3_column_bytes(row, 2) != sizeof(values)) {
    return error("its gravity is not three float64");
  }
  std::memcpy(values.data(), blob, sizeof(values));
  const Eigen::Vector3d gravity(values[0], values[1], values[2]);
  if (gravity.hasNaN()) return gravity;
  // stableNorm: the squares of large numbers overflow, and the result would be a zero direction.
  if (!gravity.allFinite() || !(gravity.stableNorm() > 1e-9)) {
    return error("its gravity is no direction");
  }
  return Eigen::Vector3d(gravity.stableNormalized());
}

}  // namespace

Result<std::map<std::string, Eigen::Vector3d>> ReadColmapGravity(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(const SqliteColmapFile file, SqliteColmapFile::Open(path));
  std::map<std::string, Eigen::Vector3d> by_name;
  MAPLOC_ASSIGN_OR_RETURN(const bool has_gravity, file.HasColumns("pose_priors", kColumns, 3));
  if (!has_gravity) return by_name;
  MAPLOC_ASSIGN_OR_RETURN(const ColmapStatement statement, file.Prepare(kQuery));
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(statement.get())) == SQLITE_ROW) {
    MAPLOC_ASSIGN_OR_RETURN(const Eigen::Vector3d gravity, ReadDirection(file, statement.get()));
    const auto* name = reinterpret_cast<const char*>(sqlite3_column_text(statement.get(), 1));
    if (name != nullptr && !gravity.hasNaN()) by_name.emplace(name, gravity);
  }
  if (code != SQLITE_DONE) return file.SqliteError("cannot be read to its end");
  return by_name;
}

}  // namespace maploc
