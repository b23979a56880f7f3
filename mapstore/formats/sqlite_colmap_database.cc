#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include "mapstore/formats/colmap.h"
#include "mapstore/formats/descriptor_faults.h"
#include "mapstore/formats/sqlite_colmap_file.h"

namespace maploc {
namespace {

constexpr std::int64_t kMaxRows = 10'000'000;  // keypoints of one image
// Between the two stands the descriptors' type, which COLMAP has since version 4.
constexpr std::string_view kSelect =
    "SELECT i.image_id, i.name, k.rows, k.cols, k.data, d.rows, d.cols, d.data, ";
constexpr std::string_view kFrom =
    " FROM images i LEFT JOIN keypoints k ON k.image_id = i.image_id "
    "LEFT JOIN descriptors d ON d.image_id = i.image_id ORDER BY i.image_id";

// What COLMAP 4's descriptors.type says of learned features; "" of those that bytes alone may
// tell: SIFT (0), undefined (-1), and databases without the column. All of them are float32.
std::string LearnedFeatures(sqlite3_stmt* row, int column) {
  constexpr std::array<const char*, 2> kNames = {"ALIKED_N16ROT", "ALIKED_N32"};
  if (sqlite3_column_type(row, column) == SQLITE_NULL) return "";
  const std::int64_t type = sqlite3_column_int64(row, column);
  if (type == 0 || type == -1) return "";
  if (type == 1 || type == 2) return kNames[static_cast<std::size_t>(type - 1)];
  return "features of type " + std::to_string(type);
}

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
      : file_(std::move(file)),
        asked_for_(kind && !kind->name.empty()),
        kind_(asked_for_ ? kind : std::nullopt) {}

  Result<std::map<std::string, ColmapFeatures>> Read() {
    MAPLOC_RETURN_IF_ERROR(CheckTables());
    MAPLOC_ASSIGN_OR_RETURN(const bool has_type, file_.HasColumns("descriptors", "'type'", 1));
    const std::string query =
        std::string(kSelect) + (has_type ? "d.type" : "NULL") + std::string(kFrom);
    MAPLOC_ASSIGN_OR_RETURN(const ColmapStatement statement, file_.Prepare(query.c_str()));
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

  Status RowError(const char* table, const ColmapFeatures& image,
                  const std::string& message) const {
    return file_.RowError(table, image.image_id, image.name.c_str(), message);
  }

  Result<ColmapFeatures> ReadImage(sqlite3_stmt* row) {
    ColmapFeatures features;
    features.image_id = sqlite3_column_int64(row, 0);
    const auto* name = reinterpret_cast<const char*>(sqlite3_column_text(row, 1));
    if (name == nullptr || *name == '\0') {
      return file_.RowError("images", features.image_id, nullptr, "has no name");
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
  Result<Block> ReadBlock(sqlite3_stmt* row, int first, const char* table,
                          const ColmapFeatures& image, std::int64_t bytes_each) const {
    Block block{sqlite3_column_int64(row, first), sqlite3_column_int64(row, first + 1),
                sqlite3_column_blob(row, first + 2)};
    // Bounded, so that the product below cannot overflow.
    if (block.rows < 0 || block.rows > kMaxRows || block.cols < 0 || block.cols > 4096) {
      return RowError(table, image, "its rows or cols are out of range");
    }
    const std::int64_t expected = block.rows * block.cols * bytes_each;
    const std::int64_t actual = sqlite3_column_bytes(row, first + 2);
    if (actual != expected) {
      return RowError(table, image,
                      "its data has " + std::to_string(actual) + " bytes, rows and cols say " +
                          std::to_string(expected));
    }
    return block;
  }

  Status ReadKeypoints(sqlite3_stmt* row, ColmapFeatures& features) const {
    MAPLOC_ASSIGN_OR_RETURN(const Block block,
                            ReadBlock(row, 2, "keypoints", features, sizeof(float)));
    if (block.rows > 0 && block.cols != 2 && block.cols != 4 && block.cols != 6) {
      return RowError("keypoints", features,
                      "cols is " + std::to_string(block.cols) + ", not 2, 4 or 6");
    }
    features.points.keypoints_px.reserve(static_cast<std::size_t>(block.rows));
    for (std::int64_t i = 0; i < block.rows; ++i) {
      // Copied, because SQLite does not promise that a blob is aligned for floats.
      std::array<float, 2> xy;
      std::memcpy(xy.data(), static_cast<const float*>(block.data) + i * block.cols, sizeof(xy));
      if (!std::isfinite(xy[0]) || !std::isfinite(xy[1])) {
        return RowError("keypoints", features, "keypoint " + std::to_string(i) + " is not finite");
      }
      features.points.keypoints_px.emplace_back(xy[0] - 0.5f, xy[1] - 0.5f);
      if (block.cols == 2) continue;
      features.scales_px.push_back(
          ScaleOf(static_cast<const float*>(block.data) + i * block.cols, block.cols));
    }
    return Status::Ok();
  }

  Status ReadDescriptors(sqlite3_stmt* row, ColmapFeatures& features) {
    MAPLOC_ASSIGN_OR_RETURN(const Block block, ReadBlock(row, 5, "descriptors", features, 1));
    MAPLOC_RETURN_IF_ERROR(CheckCount(block, features));
    const std::span bytes(static_cast<const std::uint8_t*>(block.data),
                          static_cast<std::size_t>(block.rows * block.cols));
    const auto columns = static_cast<std::size_t>(block.cols);
    const std::string learned = LearnedFeatures(row, 8);
    Descriptors& descriptors = features.points.descriptors;
    if (block.rows > 0 && (!learned.empty() || AreUnitVectors(bytes, columns))) {
      MAPLOC_ASSIGN_OR_RETURN(descriptors, FromFloats(bytes, columns, learned, features));
    } else {
      descriptors.bytes.assign(bytes.begin(), bytes.end());
    }
    const std::size_t row_bytes = descriptors.kind.bytes > 0 ? descriptors.kind.bytes : columns;
    const std::string fault = FindDescriptorFault(descriptors.bytes, row_bytes);
    if (!fault.empty()) return RowError("descriptors", features, fault);
    // A photo without features may have no columns, of which no kind can be made.
    if (block.rows > 0) MAPLOC_RETURN_IF_ERROR(SettleKind(static_cast<int>(row_bytes), features));
    if (kind_) descriptors.kind = *kind_;
    return Status::Ok();
  }

  // Learned descriptors as their kind has them. `name`: what COLMAP calls them, or "".
  Result<Descriptors> FromFloats(std::span<const std::uint8_t> bytes, std::size_t columns,
                                 const std::string& name, const ColmapFeatures& features) const {
    std::vector<float> values(bytes.size() / sizeof(float));
    if (columns % sizeof(float) != 0) {
      return RowError("descriptors", features,
                      "holds " + name + ", but its rows of " + std::to_string(columns) +
                          " bytes are no float32");
    }
    std::memcpy(values.data(), bytes.data(), bytes.size());
    Result<Descriptors> rows = FromUnitVectors(values, static_cast<int>(columns / sizeof(float)));
    if (rows.ok()) return rows;
    return RowError("descriptors", features,
                    (name.empty() ? "" : "holds " + name + ": ") + rows.status().message());
  }

  Status CheckCount(const Block& block, const ColmapFeatures& features) const {
    const auto keypoints = static_cast<std::int64_t>(features.points.keypoints_px.size());
    if (block.rows != keypoints) {
      const std::string cure =
          block.rows == 0 ? "; give --images --triangulate in place of --database" : "";
      return RowError("descriptors", features,
                      "has " + std::to_string(block.rows) + " rows, but there are " +
                          std::to_string(keypoints) + " keypoints" + cure);
    }
    return Status::Ok();
  }

  // The first image with features decides what the others must be.
  Status SettleKind(int cols, const ColmapFeatures& features) {
    // Only learned features have a kind here; all others are bytes without one.
    const DescriptorKind& found = features.points.descriptors.kind;
    if (!kind_ && found.bytes > 0) kind_ = found;
    if (kind_ && (found.bytes > 0 || kind_->name.starts_with("unit")) && found != *kind_) {
      return OtherKind(
          found.bytes > 0 ? "learned descriptors of kind " + found.name : "no learned descriptors",
          features);
    }
    if (!kind_) {
      const Result<DescriptorKind> guess = DescriptorKindFromName(
          cols == 128 ? std::string("sift_root_u8") : "binary" + std::to_string(cols));
      if (!guess.ok()) return RowError("descriptors", features, guess.status().message());
      kind_ = *guess;
    }
    if (kind_->bytes == cols) return Status::Ok();
    return OtherKind(std::to_string(cols) + " columns", features);
  }

  Status OtherKind(const std::string& has, const ColmapFeatures& features) const {
    return RowError("descriptors", features,
                    "has " + has + ", but descriptors of kind " + kind_->name + " have " +
                        std::to_string(kind_->bytes) + " columns" +
                        (asked_for_ ? "; leave --descriptors out, the database's kind is then taken"
                                    : "; extract the features of all images with one program and "
                                      "its settings"));
  }

  SqliteColmapFile file_;
  const bool asked_for_;  // kind_ was; else it is the database's
  std::optional<DescriptorKind> kind_;
};

}  // namespace

Result<std::map<std::string, ColmapFeatures>> ReadColmapDatabase(
    const std::string& path, const std::optional<DescriptorKind>& kind) {
  MAPLOC_ASSIGN_OR_RETURN(SqliteColmapFile file, SqliteColmapFile::Open(path));
  return Reader(std::move(file), kind).Read();
}

}  // namespace maploc
