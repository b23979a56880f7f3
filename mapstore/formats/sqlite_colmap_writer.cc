#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include <sqlite3.h>

#include "mapstore/formats/colmap_writer.h"

namespace maploc {
namespace {

constexpr float kHalfPixel = 0.5f;

// COLMAP 3.8's tables, without those of matches, which nobody reads here. One transaction for all,
// because SQLite syncs the disk at the end of each.
constexpr const char* kSchema =
    "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, model INTEGER NOT "
    "NULL, width INTEGER NOT NULL, height INTEGER NOT NULL, params BLOB, prior_focal_length "
    "INTEGER "
    "NOT NULL);"
    "CREATE TABLE images (image_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, name TEXT NOT NULL "
    "UNIQUE, camera_id INTEGER NOT NULL, prior_qw REAL, prior_qx REAL, prior_qy REAL, prior_qz "
    "REAL, prior_tx REAL, prior_ty REAL, prior_tz REAL);"
    "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols "
    "INTEGER NOT NULL, data BLOB);"
    "CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols "
    "INTEGER NOT NULL, data BLOB);"
    "BEGIN;";

// One connection for one file; the first failure is kept, and what follows does nothing.
class Writer {
 public:
  explicit Writer(std::string path) : path_(std::move(path)) {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    sqlite3* raw = nullptr;
    const int code = sqlite3_open(path_.c_str(), &raw);
    database_.reset(raw);
    Check(code);
    Run(kSchema);
  }

  void Camera(std::int64_t id, const maploc::Camera& camera, const std::vector<double>& params) {
    Insert("INSERT INTO cameras VALUES (?, ?, ?, ?, ?, 1)", [&](sqlite3_stmt* row) {
      sqlite3_bind_int64(row, 1, id);
      sqlite3_bind_int(row, 2, static_cast<int>(camera.model()));
      sqlite3_bind_int(row, 3, camera.width_px());
      sqlite3_bind_int(row, 4, camera.height_px());
      BindBlob(row, 5, params);
    });
  }
  void Image(const ColmapImage& image) {
    Insert("INSERT INTO images (image_id, name, camera_id) VALUES (?, ?, ?)",
           [&](sqlite3_stmt* row) {
             sqlite3_bind_int64(row, 1, image.id);
             sqlite3_bind_text(row, 2, image.name.c_str(), -1, SQLITE_TRANSIENT);
             sqlite3_bind_int64(row, 3, image.camera_id);
           });
  }
  void Features(std::int64_t image_id, const PointFeatures& points) {
    std::vector<float> keypoints;
    for (const Eigen::Vector2f& keypoint : points.keypoints_px) {
      keypoints.insert(keypoints.end(), {keypoint.x() + kHalfPixel, keypoint.y() + kHalfPixel});
    }
    Block("INSERT INTO keypoints VALUES (?, ?, ?, ?)", image_id, points.keypoints_px.size(), 2,
          keypoints);
    Block("INSERT INTO descriptors VALUES (?, ?, ?, ?)", image_id, points.descriptors.size(),
          points.descriptors.kind.bytes, points.descriptors.bytes);
  }
  Status Commit() {
    Run("COMMIT;");
    return status_;
  }

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
  };
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };

  void Check(int code) {
    if (!status_.ok() || code == SQLITE_OK || code == SQLITE_DONE) return;
    status_ = Status(StatusCode::kInternal, "WRITE_FAILED",
                     path_ + ": could not be written: " + sqlite3_errmsg(database_.get()));
  }
  void Run(const char* sql) {
    if (status_.ok()) Check(sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr));
  }
  template <typename Bind>
  void Insert(const char* sql, const Bind& bind) {
    if (!status_.ok()) return;
    sqlite3_stmt* raw = nullptr;
    Check(sqlite3_prepare_v2(database_.get(), sql, -1, &raw, nullptr));
    const std::unique_ptr<sqlite3_stmt, Finalize> row(raw);
    if (!status_.ok()) return;
    bind(raw);
    Check(sqlite3_step(raw));
  }
  template <typename T>
  static void BindBlob(sqlite3_stmt* row, int column, const std::vector<T>& values) {
    sqlite3_bind_blob64(row, column, values.data(), values.size() * sizeof(T), SQLITE_TRANSIENT);
  }
  template <typename T>
  void Block(const char* sql, std::int64_t image_id, std::size_t rows, int cols,
             const std::vector<T>& values) {
    Insert(sql, [&](sqlite3_stmt* row) {
      sqlite3_bind_int64(row, 1, image_id);
      sqlite3_bind_int64(row, 2, static_cast<sqlite3_int64>(rows));
      sqlite3_bind_int(row, 3, cols);
      BindBlob(row, 4, values);
    });
  }

  const std::string path_;
  std::unique_ptr<sqlite3, Close> database_;
  Status status_;
};

}  // namespace

Status WriteColmapDatabase(const std::string& path, const ColmapModel& model,
                           const std::map<std::string, PointFeatures>& features) {
  Writer writer(path);
  for (const auto& [id, camera] : model.cameras) {
    writer.Camera(id, camera, ColmapCameraParams(camera));
  }
  for (const auto& [id, image] : model.images) {
    writer.Image(image);
    const auto found = features.find(image.name);
    if (found != features.end()) writer.Features(id, found->second);
  }
  return writer.Commit();
}

}  // namespace maploc
