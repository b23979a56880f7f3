#include "mapstore/formats/sqlite_colmap_file.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "mapstore/base/path_kind.h"

namespace maploc {
namespace {

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

// Whether a file is there and begins with a byte that is not zero. That is how SQLite itself tells
// a journal that must be played back from one that a finished transaction emptied or zeroed.
bool HasContent(const std::string& path) { return std::ifstream(path, std::ios::binary).get() > 0; }

// Opened immutable, SQLite looks at neither log, and would read what is half written. Both lie
// beside the file itself, not beside a link to it.
Status CheckLogs(const std::string& path) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::canonical(path, error);
  const std::string base = error ? path : target.string();
  if (const std::string log = base + "-wal";
      std::filesystem::exists(log, error) && std::filesystem::file_size(log, error) > 0) {
    return InvalidFile(path,
                       "has a write-ahead log beside it (" + log +
                           "), so another program is writing it or died; close that program, or "
                           "run: sqlite3 " +
                           base + " 'PRAGMA wal_checkpoint(TRUNCATE)'");
  }
  if (const std::string journal = base + "-journal"; HasContent(journal)) {
    return InvalidFile(path, "has a rollback journal beside it (" + journal +
                                 "), so another program is writing it or died half way; close that "
                                 "program, or take its half back with: sqlite3 " +
                                 base + " 'PRAGMA integrity_check'");
  }
  return Status::Ok();
}

// SQLite notices missing pages only when it comes to them; the header (its format is documented)
// tells at once.
Status CheckHeader(const std::string& path) {
  std::error_code error;
  if (!Exists(path)) return NotFound("database '" + path + "'", "FILE_NOT_FOUND");
  if (!IsRegularFile(path)) return InvalidFile(path, "is not a regular file");
  // First, because a database whose pages are all in its log looks like an empty file.
  MAPLOC_RETURN_IF_ERROR(CheckLogs(path));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::array<unsigned char, 100> header{};
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(header.data()), header.size());
  if (error || !file || std::memcmp(header.data(), "SQLite format 3", 16) != 0) {
    return InvalidFile(path, "is not an SQLite database (or is cut off in its first 100 bytes)");
  }
  // A page of 65536 bytes does not fit the header's 16 bits and is written as 1.
  const std::uint32_t page =
      header[16] == 0 && header[17] == 1 ? 65536u : std::uint32_t{header[16]} << 8 | header[17];
  // Old versions of SQLite leave the page count as it is. It holds only if the file's change
  // counter equals the one that was written with it.
  const bool count_is_valid = BigEndian32(&header[24]) == BigEndian32(&header[92]);
  const std::uint64_t expected = std::uint64_t{page} * BigEndian32(&header[28]);
  if (count_is_valid && size < expected) {
    return InvalidFile(path, "is truncated: its header promises " + std::to_string(expected) +
                                 " bytes, it has " + std::to_string(size));
  }
  return Status::Ok();
}

}  // namespace

Result<SqliteColmapFile> SqliteColmapFile::Open(const std::string& path) {
  MAPLOC_RETURN_IF_ERROR(CheckHeader(path));
  SqliteColmapFile file;
  file.path_ = path;
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(ImmutableUri(path).c_str(), &raw,
                                   SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  file.database_.reset(raw);
  if (code != SQLITE_OK) return file.SqliteError("cannot be opened");
  // The file is not ours: its schema must not be able to run anything.
  sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  return file;
}

Result<ColmapStatement> SqliteColmapFile::Prepare(const char* sql) const {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql, -1, &raw, nullptr) != SQLITE_OK) {
    return SqliteError("is not a COLMAP database");
  }
  return ColmapStatement(raw);
}

Status SqliteColmapFile::SqliteError(const std::string& what) const {
  return InvalidFile(path_, what + ": " + sqlite3_errmsg(database_.get()));
}

Status SqliteColmapFile::RowError(const char* table, std::int64_t image_id, const char* name,
                                  const std::string& message) const {
  std::string where = "table " + std::string(table) + ", image " + std::to_string(image_id);
  if (name != nullptr) where += " ('" + std::string(name) + "')";
  return InvalidFile(path_, where + ": " + message);
}

Result<bool> SqliteColmapFile::HasColumns(const std::string& table, const std::string& names,
                                          int count) const {
  const std::string sql =
      "SELECT count(*) FROM pragma_table_info('" + table + "') WHERE name IN (" + names + ")";
  MAPLOC_ASSIGN_OR_RETURN(const ColmapStatement statement, Prepare(sql.c_str()));
  if (sqlite3_step(statement.get()) != SQLITE_ROW) return SqliteError("cannot be read");
  return sqlite3_column_int(statement.get(), 0) == count;
}

}  // namespace maploc
