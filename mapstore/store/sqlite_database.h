// SQLite behind values of ours: a connection, a prepared statement, a transaction that rolls back
// unless it was committed. Nothing here is thread-safe; whoever shares a connection guards it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/store/file_state.h"

struct sqlite3;
struct sqlite3_stmt;

namespace maploc {

enum class SqliteAccess {
  kRead,
  kWrite,
  kCreate,
  kReadOnly,  // where nothing may be written, beside a program that does
  // Reads the main file as it lies there: no lock, no log, and nothing appears beside. SQLite takes
  // it that nobody changes the file; CheckUnchanged tells whether that was so.
  kFileAlone,
};

// DATA_LOSS (INVALID_FILE). `what` goes on after "it": "is empty".
Status NotAStore(const std::string& path, std::string_view what);

class SqliteDatabase {
 public:
  // kRead, kReadOnly and kFileAlone refuse every write. DATA_LOSS where the file is damaged,
  // UNAVAILABLE where it cannot be opened; messages name the file.
  static Result<SqliteDatabase> Open(const std::string& path, SqliteAccess access,
                                     int busy_timeout_ms);

  const std::string& path() const { return path_; }
  SqliteAccess access() const { return access_; }
  bool IsReadOnly() const {
    return access_ == SqliteAccess::kReadOnly || access_ == SqliteAccess::kFileAlone;
  }
  sqlite3* handle() const { return handle_.get(); }
  // One or more statements without results.
  Status Execute(const std::string& sql);
  std::int64_t LastInsertId() const;
  // Rows that the last INSERT, UPDATE or DELETE touched.
  std::int64_t ChangedRows() const;
  // kFileAlone: UNAVAILABLE (STORE_REPLACED) where the file is not as it was at Open, or a log has
  // begun beside it; what has been read since may be of two states. Else Ok. Thread-safe; takes a
  // few microseconds.
  Status CheckUnchanged() const;
  // What SQLite's result code means here. REQUIRES: it is a failure.
  Status ErrorOf(int result_code) const;

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  SqliteDatabase(std::string path, SqliteAccess access, sqlite3* handle)
      : path_(std::move(path)), access_(access), handle_(handle) {}

  std::string path_;
  SqliteAccess access_;
  std::optional<FileState> seen_;  // kFileAlone: before it was opened
  std::unique_ptr<sqlite3, Close> handle_;
};

// A string literal: it can be compared by its address.
struct ColumnName {
  consteval ColumnName(const char* literal) : text(literal) {}  // NOLINT: implicit on purpose
  std::string_view text;
};

// Failures of preparing and binding are kept and returned by the next Step or Run.
class SqliteStatement {
 public:
  SqliteStatement(SqliteDatabase& database, std::string_view sql);

  // Binds the parameters ?1, ?2, ... and starts anew: integers, doubles, text, bytes (borrowed
  // until the next Bind), nullopt as NULL.
  template <typename... Values>
  SqliteStatement& Bind(const Values&... values) {
    Reset();
    int index = 0;
    (BindOne(++index, values), ...);
    return *this;
  }
  // True: a row is there. False: done.
  Result<bool> Step();
  // For statements without rows.
  Status Run();
  // All rows that are left, each as `at(*this)` reads it.
  template <typename At>
  auto Collect(const At& at) -> Result<std::vector<std::invoke_result_t<At, SqliteStatement&>>> {
    std::vector<std::invoke_result_t<At, SqliteStatement&>> rows;
    while (true) {
      MAPLOC_ASSIGN_OR_RETURN(const bool row, Step());
      if (!row) return rows;
      rows.push_back(at(*this));
    }
  }

  // The column with this name (without the name of its table). Fastest in the order of the SELECT.
  // Throws std::logic_error if no column has the name or two columns share one; both are errors of
  // the program. REQUIRES: Step gave a row.
  bool IsNull(ColumnName column) const;
  std::int64_t Int(ColumnName column) const;
  std::int32_t Int32(ColumnName column) const { return static_cast<std::int32_t>(Int(column)); }
  bool Bool(ColumnName column) const { return Int(column) != 0; }
  template <typename E>
  E Enum(ColumnName column) const {
    return static_cast<E>(Int(column));
  }
  double Real(ColumnName column) const;
  std::string Text(ColumnName column) const;
  std::span<const std::uint8_t> Bytes(ColumnName column) const;  // valid until the next Step
  std::vector<std::uint8_t> Blob(ColumnName column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  void Reset();
  int IndexOf(ColumnName column) const;
  void Keep(int result_code);
  void BindOne(int index, std::int64_t value);
  void BindOne(int index, std::int32_t value) { BindOne(index, static_cast<std::int64_t>(value)); }
  void BindOne(int index, bool value) { BindOne(index, static_cast<std::int64_t>(value)); }
  void BindOne(int index, double value);
  void BindOne(int index, std::string_view text);
  void BindOne(int index, const std::string& text) { BindOne(index, std::string_view(text)); }
  void BindOne(int index, const char* text) { BindOne(index, std::string_view(text)); }
  void BindOne(int index, const std::vector<std::uint8_t>& bytes);
  void BindOne(int index, std::optional<std::int64_t> value);

  SqliteDatabase& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  int result_code_;  // the first failure, else SQLITE_OK
  // The columns' names, from the first read to the next Bind: SQLite's, then the literals that read
  // them, so that later rows compare only addresses.
  mutable std::vector<std::string_view> columns_;
  mutable std::size_t next_ = 0;  // the column after the last one read
};

// "(?1, ?2, ?3)" for "a, b, c".
std::string ParametersFor(std::string_view columns);

class SqliteTransaction {
 public:
  // kRead sees one state of the database throughout; kWrite waits for other writers.
  enum class Kind { kRead, kWrite };
  static Result<SqliteTransaction> Begin(SqliteDatabase& database, Kind kind);

  SqliteTransaction(SqliteTransaction&& other) noexcept;
  SqliteTransaction& operator=(SqliteTransaction&&) = delete;
  ~SqliteTransaction();  // rolls back unless committed

  Status Commit();

 private:
  explicit SqliteTransaction(SqliteDatabase& database) : database_(&database) {}

  SqliteDatabase* database_;  // null once committed or moved from
};

}  // namespace maploc
