#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <utility>

#include <sqlite3.h>

#include "mapstore/formats/colmap.h"

namespace maploc {
namespace {

constexpr std::int64_t kMaxRows = 10'000'000;  // keypoints of one image
constexpr const char* kQuery =
    "SELECT i.image_id, i.name, k.rows, k.cols, k.data, d.rows, d.cols, d.data FROM images i "
    "LEFT JOIN keypoints k ON k.image_id = i.image_id "
    "LEFT JOIN descriptors d ON d.image_id = i.image_id ORDER BY i.image_id";

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

// A file path as an SQLite URI. Immutable: the file may lie on a read-only disk, and no lock,
// journal or shared-memory file must appear beside it.
std::string ImmutableUri(const std::string& path) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path).string()) {
    if (c == '%' || c == '?' || c == '#') {
      constexpr std::string_view kHex = "0123456789abcdef";
      uri += {'%', kHex[static_cast<unsigned char>(c) >> 4], kHex[c & 15]};
    } else {
      uri += c;
    }
  }
  return uri + "?mode=ro&immutable=1";
}

std::uint32_t BigEndian32(const unsigned char* b) {
  return std::uint32_t{b[0]} << 24 | std::uint32_t{b[1]} << 16 | std::uint32_t{b[2]} << 8 | b[3];
}

// SQLite notices missing pages only when it comes to them; the header (its format is documented)
// tells at once.
Status CheckHeader(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path)) return NotFound("database '" + path + "'", "FILE_NOT_FOUND");
  if (!std::filesystem::is_regular_file(path)) return InvalidFile(path, "is not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::array<unsigned char, 100> header{};
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(header.data()), header.size());
  if (error || !file || std::memcmp(header.data(), "SQLite format 3", 16) != 0) {
    return InvalidFile(path, "is not an SQLite database (or is cut off in its first 100 bytes)");
  }
  const std::uint32_t page =
      header[16] == 0 && header[17] == 1 ? 65536u : std::uint32_t{header[16]} << 8 | header[17];
  const bool count_is_valid = BigEndian32(&header[24]) == BigEndian32(&header[92]);
  const std::uint64_t expected = std::uint64_t{page} * BigEndian32(&header[28]);
  if (count_is_valid && size < expected) {
    return InvalidFile(path, "is truncated: its header promises " + std::to_string(expected) +
                                 " bytes, it has " + std::to_string(size));
  }
  const std::string log = path + "-wal";
  if (std::filesystem::exists(log) && std::filesystem::file_size(log, error) > 0) {
    return InvalidFile(
        path,
        "has a write-ahead log beside it, so another program is writing it or died; "
        "close that program, or run: sqlite3 FILE 'PRAGMA wal_checkpoint(TRUNCATE)'");
  }
  return Status::Ok();
}

class Reader {
 public:
  Reader(std::string path, const std::optional<DescriptorKind>& kind)
      : path_(std::move(path)), kind_(kind && !kind->name.empty() ? kind : std::nullopt) {}

  Result<std::map<std::string, ColmapFeatures>> Read() {
    MAPLOC_RETURN_IF_ERROR(CheckHeader(path_));
    MAPLOC_RETURN_IF_ERROR(Open());
    MAPLOC_RETURN_IF_ERROR(CheckTables());
    MAPLOC_ASSIGN_OR_RETURN(const Statement statement, Prepare(kQuery));
    std::map<std::string, ColmapFeatures> images;
    int code = SQLITE_ROW;
    while ((code = sqlite3_step(statement.get())) == SQLITE_ROW) {
      MAPLOC_ASSIGN_OR_RETURN(ColmapFeatures features, ReadImage(statement.get()));
      const std::string name = features.name;
      if (!images.emplace(name, std::move(features)).second) {
        return InvalidFile(path_, "table images: the name '" + name + "' stands twice");
      }
    }
    if (code != SQLITE_DONE) return SqliteError("cannot be read to its end");
    return images;
  }

 private:
  Status Open() {
    sqlite3* raw = nullptr;
    const int code = sqlite3_open_v2(ImmutableUri(path_).c_str(), &raw,
                                     SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(raw);
    if (code != SQLITE_OK) return SqliteError("cannot be opened");
    // The file is not ours: its schema must not be able to run anything.
    sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    return Status::Ok();
  }

  Status CheckTables() {
    MAPLOC_ASSIGN_OR_RETURN(const Statement statement,
                            Prepare("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND "
                                    "name IN ('images', 'keypoints', 'descriptors')"));
    if (sqlite3_step(statement.get()) != SQLITE_ROW) return SqliteError("cannot be read");
    if (sqlite3_column_int(statement.get(), 0) == 3) return Status::Ok();
    return InvalidFile(path_,
                       "is not a COLMAP database: it lacks a table images, keypoints or "
                       "descriptors");
  }

  Result<Statement> Prepare(const char* sql) {
    sqlite3_stmt* raw = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql, -1, &raw, nullptr) != SQLITE_OK) {
      return SqliteError("is not a COLMAP database");
    }
    return Statement(raw);
  }

  Status SqliteError(const std::string& what) const {
    return InvalidFile(path_, what + ": " + sqlite3_errmsg(database_.get()));
  }

  Status RowError(const char* table, std::int64_t image_id, const std::string& message) const {
    return InvalidFile(path_, "table " + std::string(table) + ", image " +
                                  std::to_string(image_id) + ": " + message);
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

  std::string path_;
  std::optional<DescriptorKind> kind_;
  Database database_;
};

}  // namespace

Result<std::map<std::string, ColmapFeatures>> ReadColmapDatabase(
    const std::string& path, const std::optional<DescriptorKind>& kind) {
  return Reader(path, kind).Read();
}

}  // namespace maploc
