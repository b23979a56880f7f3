// COLMAP's database.db, opened to be read and never to be written. Not thread-safe.
#pragma once

#include <memory>
#include <string>

#include <sqlite3.h>

#include "mapstore/base/status.h"

namespace maploc {

struct FinalizeColmapStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using ColmapStatement = std::unique_ptr<sqlite3_stmt, FinalizeColmapStatement>;

class SqliteColmapFile {
 public:
  // Error: the file is not there, is no database, is cut off, is being written, or holds what a
  // program that died left half written.
  static Result<SqliteColmapFile> Open(const std::string& path);

  Result<ColmapStatement> Prepare(const char* sql) const;
  // The path, `what`, and SQLite's own words for the last failure.
  Status SqliteError(const std::string& what) const;
  // "path: table descriptors, image 7 ('b.jpg'): message". `name` may be null: there is none.
  Status RowError(const char* table, std::int64_t image_id, const char* name,
                  const std::string& message) const;
  // Whether a table has the columns; not so without the table. `names` as SQL: "'type', 'cols'".
  Result<bool> HasColumns(const std::string& table, const std::string& names, int count) const;
  const std::string& path() const { return path_; }

 private:
  struct CloseDatabase {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
  };

  std::string path_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
};

}  // namespace maploc
