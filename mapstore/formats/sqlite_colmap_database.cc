#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "mapstore/formats/colmap.h"
#include "mapstore/formats/sqlite_colmap_file.h"

namespace maploc {
namespace {

constexpr std::int64_t kMaxRows = 10'000'000;  // keypoints of one image
constexpr const char* kQuery =
    "SELECT i.image_id, i.name, k.rows, k.cols, k.data, d.rows, d.cols, d.data FROM images i "
    "LEFT JOIN keypoints k ON k.image_id = i.image_id "
    "LEFT JOIN descriptors d ON d.image_id = i.image_id ORDER BY i.image_id";

// Of a row (x, y, scale, orientation) or (x, y, a11, a12, a21, a22), as COLMAP has it: of an affine
// shape the mean of its axes' lengths.
float ScaleOf(const float* keypoint, std::int64_t cols) {
  std::array<float, 4> shape{};
  std::memcpy(shape.data(), keypoint + 2, static_cast<std::size_t>(cols - 2) * sizeof(float));
  const float scale =
      cols == 4 ? shape[0]
                : (std::hypot(shape[0], shape[2]) + std::hypot(shape[1], shape[3])) / 2.0f;
  return std::isfinite(scale) ? scale : 0.0f;
}

class Reader {
 public:
  Reader(SqliteColmapFile file, const std::optional<DescriptorKind>& kind)
      : file_(std::move(file)), kind_(kind && !kind->name.empty() ? kind : std::nullopt) {}

  Result<std::map<std::string, ColmapFeatures>> Read() {
    MAPLOC_RETURN_IF_ERROR(CheckTables());
    MAPLOC_ASSIGN_OR_RETURN(const ColmapStatement statement, file_.Prepare(kQuery));
    std::map<std::string, ColmapFeatures> images;
    int code = SQLITE_ROW;
    while ((code = sqlite3_step(statement.get())) == SQLITE_ROW) {
      MAPLOC_ASSIGN_OR_RETURN(ColmapFeatures features, ReadImage(statement.get()));
      const std::string name = features.name;
      if (!images.emplace(name, std::move(features)).second) {
        return InvalidFile(file_.path(), "table images: the name '" + name + "' stands twice");
      }
    }
    if (code != SQLITE_DONE) return file_.SqliteError("cannot be read to its end");
    return images;
  }

 private:
  Status CheckTables() {
    MAPLOC_ASSIGN_OR_RETURN(
        const ColmapStatement statement,
        file_.Prepare("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND "
                      "name IN ('images', 'keypoints', 'descriptors')"));
    if (sqlite3_step(statement.get()) != SQLITE_ROW) return file_.SqliteError("cannot be read");
    if (sqlite3_column_int(statement.get(), 0) == 3) return Status::Ok();
    return InvalidFile(file_.path(),
                       "is not a COLMAP database: it lacks a table images, keypoints or "
                       "descriptors");
  }

  Status RowError(const char* table, std::int64_t image_id, const std::string& message) const {
    return file_.RowError(table, image_id, message);
  }

  Result<ColmapFeatures> ReadImage(sqlite3_stmt* row) {
    ColmapFeatures features;
    features.image_id = sqlite3_column_int64(row, 0);
    const auto* name = reinterpret_cast<const char*>(sqlite3_column_text(row, 1));
    if (name == nullptr || *name == '\0') {
      return RowError("images", features.image_id, "has no name");
    }
    features.name = name;
    MAPLOC_RETURN_IF_ERROR(ReadKeypoints(row, features));
    MAPLOC_RETURN_IF_ERROR(ReadDescriptors(row, features));
    return features;
  }

  // Rows and columns of a table's blob from column `first` on, checked against the blob's length.
  // An image without a row in the table has none.
  struct Block {
    std::int64_t rows = 0;
    std::int64_t cols = 0;
    const void* data = nullptr;
  };
  Result<Block> ReadBlock(sqlite3_stmt* row, int first, const char* table, std::int64_t image_id,
                          std::int64_t bytes_each) const {
    Block block{sqlite3_column_int64(row, first), sqlite3_column_int64(row, first + 1),
                sqlite3_column_blob(row, first + 2)};
    if (block.rows < 0 || block.rows > kMaxRows || block.cols < 0 || block.cols > 4096) {
      return RowError(table, image_id, "its rows or cols are out of range");
    }
    const std::int64_t expected = block.rows * block.cols * bytes_each;
    const std::int64_t actual = sqlite3_column_bytes(row, first + 2);
    if (actual != expected) {
      return RowError(table, image_id,
                      "its data has " + std::to_string(actual) + " bytes, rows and cols say " +
                          std::to_string(expected));
    }
    return block;
  }

  Status ReadKeypoints(sqlite3_stmt* row, ColmapFeatures& features) const {
    const std::int64_t id = features.image_id;
    MAPLOC_ASSIGN_OR_RETURN(const Block block, ReadBlock(row, 2, "keypoints", id, sizeof(float)));
    if (block.rows > 0 && block.cols != 2 && block.cols != 4 && block.cols != 6) {
      return RowError("keypoints", id, "cols is " + std::to_string(block.cols) + ", not 2, 4 or 6");
    }
    features.points.keypoints_px.reserve(static_cast<std::size_t>(block.rows));
    for (std::int64_t i = 0; i < block.rows; ++i) {
      std::array<float, 2> xy;
      std::memcpy(xy.data(), static_cast<const float*>(block.data) + i * block.cols, sizeof(xy));
      if (!std::isfinite(xy[0]) || !std::isfinite(xy[1])) {
        return RowError("keypoints", id, "keypoint " + std::to_string(i) + " is not finite");
      }
      features.points.keypoints_px.emplace_back(xy[0] - 0.5f, xy[1] - 0.5f);
      if (block.cols == 2) continue;
      features.scales_px.push_back(
          ScaleOf(static_cast<const float*>(block.data) + i * block.cols, block.cols));
    }
    return Status::Ok();
  }

  Status ReadDescriptors(sqlite3_stmt* row, ColmapFeatures& features) {
    const std::int64_t id = features.image_id;
    MAPLOC_ASSIGN_OR_RETURN(const Block block, ReadBlock(row, 5, "descriptors", id, 1));
    const auto keypoints = static_cast<std::int64_t>(features.points.keypoints_px.size());
    if (block.rows != keypoints) {
      return RowError("descriptors", id,
                      "has " + std::to_string(block.rows) + " rows, but there are " +
                          std::to_string(keypoints) + " keypoints");
    }
    if (block.rows > 0) MAPLOC_RETURN_IF_ERROR(SettleKind(block.cols, id));
    const auto* bytes = static_cast<const std::uint8_t*>(block.data);
    features.points.descriptors.bytes.assign(bytes, bytes + block.rows * block.cols);
    if (kind_) features.points.descriptors.kind = *kind_;
    return Status::Ok();
  }

  // The first image with features decides what the others must be.
  Status SettleKind(std::int64_t cols, std::int64_t image_id) {
    if (!kind_) {
      const Result<DescriptorKind> guess = DescriptorKindFromName(
          cols == 128 ? std::string("sift_root_u8") : "binary" + std::to_string(cols));
      if (!guess.ok()) return RowError("descriptors", image_id, guess.status().message());
      kind_ = *guess;
    }
    if (kind_->bytes == cols) return Status::Ok();
    return RowError("descriptors", image_id,
                    "has " + std::to_string(cols) + " columns, but descriptors of kind " +
                        kind_->name + " have " + std::to_string(kind_->bytes));
  }

  SqliteColmapFile file_;
  std::optional<DescriptorKind> kind_;
};

}  // namespace

Result<std::map<std::string, ColmapFeatures>> ReadColmapDatabase(
    const std::string& path, const std::optional<DescriptorKind>& kind) {
  MAPLOC_ASSIGN_OR_RETURN(SqliteColmapFile file, SqliteColmapFile::Open(path));
  return Reader(std::move(file), kind).Read();
}

}  // namespace maploc
