#include "mapstore/store/sqlite_database.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <thread>

#include <sqlite3.h>

#include "mapstore/base/wait_limit.h"
#include "mapstore/store/beside_store.h"

namespace maploc {
namespace {

int OpenFlags(SqliteAccess access) {
  // SQLite takes `immutable` only as a parameter of a URI.
  if (access == SqliteAccess::kFileAlone) {
    return SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
  }
  if (access == SqliteAccess::kReadOnly) return SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_READONLY;
  // Connections are guarded by their owners, so SQLite needs no mutex of its own. Readers open for
  // writing too, because only then can they take part in the write-ahead log's shared memory;
  // query_only keeps them from writing.
  const int flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_READWRITE;
  return access == SqliteAccess::kCreate ? flags | SQLITE_OPEN_CREATE : flags;
}

// SQLite gives names like ":memory:" and "" a meaning of their own; behind a folder they are files.
std::string FileName(const std::string& path) { return path.starts_with('/') ? path : "./" + path; }

// `immutable` is what keeps SQLite from looking at the log and at locks.
std::string FileAloneUri(const std::string& path) {
  std::string uri = "file:";
  for (const char c : FileName(path)) {
    if (c == '%' || c == '?' || c == '#') {
      uri += c == '%' ? "%25" : c == '?' ? "%3f" : "%23";
    } else {
      uri += c;
    }
  }
  return uri + "?immutable=1";
}

// Sleeps about one millisecond at a time. SQLite's own handler sleeps up to 100 ms between two
// attempts, and an import that takes the lock again and again would win it from an EndSession that
// sleeps. `timeout_ms` is a number in the place of a pointer, so that nothing has to outlive the
// connection.
int WaitForLock(void* timeout_ms, int times_before) {
  if (times_before >= reinterpret_cast<std::intptr_t>(timeout_ms)) return 0;
  if (WaitLimit::HasPassed()) return 0;
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return 1;
}

Status DiskFull(const std::string& where) {
  return ResourceExhausted("DISK_FULL", where + "the disk is full; free some space");
}

// Commits fail while SQLite writes the log. It keeps that error's number with the log's file and
// not with the connection, where sqlite3_system_errno looks.
int LastSystemError(sqlite3* handle) {
  sqlite3_file* log = nullptr;
  sqlite3_file_control(handle, "main", SQLITE_FCNTL_JOURNAL_POINTER, &log);
  int error = 0;
  if (log != nullptr && log->pMethods != nullptr) {
    log->pMethods->xFileControl(log, SQLITE_FCNTL_LAST_ERRNO, &error);
  }
  return error != 0 ? error : sqlite3_system_errno(handle);
}

// A full disk is SQLITE_FULL if a write fails, but SQLITE_IOERR if lengthening a file does.
Status IoFailed(const std::string& where, const std::string& what, int system_error) {
  if (system_error == ENOSPC || system_error == EDQUOT) return DiskFull(where);
  if (system_error == EFBIG) {
    return ResourceExhausted(
        "DISK_FULL", where +
                         "a file of the store may not grow further: it is at this process's limit "
                         "(`ulimit -f`) or at the file system's largest file; raise the limit and "
                         "start again, or move the store to another file system");
  }
  if (system_error == EROFS) {
    return Status(StatusCode::kUnavailable, "STORE_NOT_WRITABLE",
                  where +
                      "its file system has become read-only, as after an error of the disk (see "
                      "dmesg); check the disk and mount it for writing again");
  }
  return Status(StatusCode::kUnavailable, "STORE_IO",
                where + "input or output failed (" + what + "); check the disk");
}

bool LacksLogIndex(const std::string& path) {
  std::error_code none;
  return std::filesystem::exists(BesideStore(path, "-wal"), none) &&
         !std::filesystem::exists(BesideStore(path, "-shm"), none);
}

Status LogWithoutIndex(const std::string& path) {
  return Status(StatusCode::kUnavailable, "STORE_NOT_WRITABLE",
                path + ": its last program has crashed and left a log, " +
                    BesideStore(path, "-wal") +
                    ", which cannot be read without an index beside it, and this user may not "
                    "write one; let the store's owner open it once (`maploc-map list --store " +
                    path + "`)");
}

std::logic_error WrongColumn(sqlite3_stmt* statement, std::string_view column) {
  return std::logic_error("not exactly one column '" + std::string(column) + "' in " +
                          sqlite3_sql(statement));
}

std::vector<std::string_view> ColumnNames(sqlite3_stmt* statement) {
  std::vector<std::string_view> names(static_cast<std::size_t>(sqlite3_column_count(statement)));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const char* name = sqlite3_column_name(statement, static_cast<int>(i));
    // SQLite returns a null pointer if it has no memory for the name.
    if (name == nullptr) throw std::bad_alloc();
    names[i] = name;
  }
  // Columns of joined tables can have the same name. Reading one by name would then silently give
  // the first.
  std::vector<std::string_view> sorted = names;
  std::ranges::sort(sorted);
  const auto twice = std::ranges::adjacent_find(sorted);
  if (twice != sorted.end()) throw WrongColumn(statement, *twice);
  return names;
}

}  // namespace

Status NotAStore(const std::string& path, std::string_view what) {
  return Status(StatusCode::kDataLoss, "INVALID_FILE",
                path + ": is not a maploc store (it " + std::string(what) + ")");
}

void SqliteDatabase::Close::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }

Result<SqliteDatabase> SqliteDatabase::Open(const std::string& path, SqliteAccess access,
                                            int busy_timeout_ms) {
  sqlite3* handle = nullptr;
  std::optional<FileState> seen;
  // Before the file is opened, so that a change while it is being opened is noticed too.
  if (access == SqliteAccess::kFileAlone) seen = FileState::Of(path);
  const std::string name = access == SqliteAccess::kFileAlone ? FileAloneUri(path) : FileName(path);
  const int result = sqlite3_open_v2(name.c_str(), &handle, OpenFlags(access), nullptr);
  // SQLite gives a handle even after a failure: it has the error's text and must be closed.
  SqliteDatabase database(path, access, handle);
  database.seen_ = seen;
  if (result != SQLITE_OK) return database.ErrorOf(result);
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_handler(handle, &WaitForLock,
                       reinterpret_cast<void*>(static_cast<std::intptr_t>(busy_timeout_ms)));
  // FULL, because with a write-ahead log NORMAL loses the last commits at a power failure. The last
  // two are SQLite's advice for files that may be damaged or come from others.
  MAPLOC_RETURN_IF_ERROR(
      database.Execute("PRAGMA foreign_keys = ON; PRAGMA synchronous = FULL; "
                       "PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON;"));
  if (access == SqliteAccess::kRead) {
    MAPLOC_RETURN_IF_ERROR(database.Execute("PRAGMA query_only = ON"));
  }
  return database;
}

Status SqliteDatabase::Execute(const std::string& sql) {
  const int result = sqlite3_exec(handle(), sql.c_str(), nullptr, nullptr, nullptr);
  return result == SQLITE_OK ? Status::Ok() : ErrorOf(result);
}

std::int64_t SqliteDatabase::LastInsertId() const { return sqlite3_last_insert_rowid(handle()); }

std::int64_t SqliteDatabase::ChangedRows() const { return sqlite3_changes64(handle()); }

Status SqliteDatabase::CheckUnchanged() const {
  if (!seen_ || FileState::Of(path_) == seen_) return Status::Ok();
  return Status(StatusCode::kUnavailable, "STORE_REPLACED",
                path_ +
                    ": the store was changed by another program while this one had it open for "
                    "reading only; open it again (restart the server that serves it)");
}

Status SqliteDatabase::ErrorOf(int result_code) const {
  const std::string what = handle_ ? sqlite3_errmsg(handle()) : sqlite3_errstr(result_code);
  const std::string where = path_ + ": ";
  const int primary_code = result_code & 0xff;
  if (primary_code == SQLITE_NOTADB || primary_code == SQLITE_CORRUPT) {
    MAPLOC_RETURN_IF_ERROR(CheckUnchanged());  // half of a change looks like damage
  }
  switch (primary_code) {
    case SQLITE_NOTADB:
      return NotAStore(path_, "is not an SQLite database");
    case SQLITE_CORRUPT:
      return Status(
          StatusCode::kDataLoss, "DAMAGED_STORE",
          where + "the store is truncated or damaged (" + what + "); restore it from a backup");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return Status(StatusCode::kUnavailable, "STORE_BUSY",
                    where + "another process holds the store; try again");
    case SQLITE_FULL:
      return DiskFull(where);
    case SQLITE_CANTOPEN:
      if (access_ == SqliteAccess::kReadOnly && LacksLogIndex(path_)) return LogWithoutIndex(path_);
      [[fallthrough]];
    case SQLITE_PERM:
    case SQLITE_AUTH:
    case SQLITE_READONLY:
      return Status(StatusCode::kUnavailable, "STORE_NOT_WRITABLE",
                    where + "cannot be opened for writing (" + what +
                        "); check that the folder exists and its permissions");
    case SQLITE_IOERR:
      return IoFailed(where, what, handle_ ? LastSystemError(handle()) : 0);
    default:
      return Internal(where + what);
  }
}

void SqliteStatement::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

SqliteStatement::SqliteStatement(SqliteDatabase& database, std::string_view sql)
    : database_(database) {
  sqlite3_stmt* statement = nullptr;
  result_code_ = sqlite3_prepare_v2(database.handle(), sql.data(), static_cast<int>(sql.size()),
                                    &statement, nullptr);
  statement_.reset(statement);
}

void SqliteStatement::Reset() {
  sqlite3_reset(statement_.get());
  // SQLite may prepare a statement again when it runs, and the names that it gave end with that.
  columns_.clear();
}

void SqliteStatement::Keep(int result_code) {
  if (result_code_ == SQLITE_OK) result_code_ = result_code;
}

void SqliteStatement::BindOne(int index, std::int64_t value) {
  Keep(sqlite3_bind_int64(statement_.get(), index, value));
}

void SqliteStatement::BindOne(int index, double value) {
  Keep(sqlite3_bind_double(statement_.get(), index, value));
}

void SqliteStatement::BindOne(int index, std::string_view text) {
  Keep(sqlite3_bind_text64(statement_.get(), index, text.data(), text.size(), SQLITE_TRANSIENT,
                           SQLITE_UTF8));
}

void SqliteStatement::BindOne(int index, const std::vector<std::uint8_t>& bytes) {
  // An empty vector's data may be null, which SQLite would take for NULL.
  const void* data = bytes.empty() ? static_cast<const void*>("") : bytes.data();
  Keep(sqlite3_bind_blob64(statement_.get(), index, data, bytes.size(), SQLITE_STATIC));
}

void SqliteStatement::BindOne(int index, std::optional<std::int64_t> value) {
  if (value) {
    BindOne(index, *value);
  } else {
    Keep(sqlite3_bind_null(statement_.get(), index));
  }
}

Result<bool> SqliteStatement::Step() {
  if (result_code_ != SQLITE_OK) return database_.ErrorOf(result_code_);
  const int result = sqlite3_step(statement_.get());
  if (result == SQLITE_ROW) return true;
  if (result == SQLITE_DONE) return false;
  return database_.ErrorOf(result);
}

Status SqliteStatement::Run() {
  MAPLOC_ASSIGN_OR_RETURN(const bool row, Step());
  static_cast<void>(row);
  Reset();
  return Status::Ok();
}

int SqliteStatement::IndexOf(ColumnName column) const {
  // From a statement's second row on, the literals are in place and comparing addresses is enough.
  if (next_ >= columns_.size() || columns_[next_].data() != column.text.data()) {
    if (columns_.empty()) columns_ = ColumnNames(statement_.get());
    if (next_ >= columns_.size() || columns_[next_] != column.text) {
      next_ = static_cast<std::size_t>(std::ranges::find(columns_, column.text) - columns_.begin());
    }
    if (next_ == columns_.size()) throw WrongColumn(statement_.get(), column.text);
    columns_[next_] = column.text;
  }
  return static_cast<int>(next_++);
}

bool SqliteStatement::IsNull(ColumnName column) const {
  return sqlite3_column_type(statement_.get(), IndexOf(column)) == SQLITE_NULL;
}

std::int64_t SqliteStatement::Int(ColumnName column) const {
  return sqlite3_column_int64(statement_.get(), IndexOf(column));
}

double SqliteStatement::Real(ColumnName column) const {
  return sqlite3_column_double(statement_.get(), IndexOf(column));
}

std::string SqliteStatement::Text(ColumnName column) const {
  const std::span<const std::uint8_t> bytes = Bytes(column);
  return std::string(bytes.begin(), bytes.end());
}

std::span<const std::uint8_t> SqliteStatement::Bytes(ColumnName column) const {
  const int index = IndexOf(column);
  // SQLite's documentation wants the length asked for after the pointer: asking may convert the
  // value.
  const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_.get(), index));
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), index))};
}

std::vector<std::uint8_t> SqliteStatement::Blob(ColumnName column) const {
  const std::span<const std::uint8_t> bytes = Bytes(column);
  return {bytes.begin(), bytes.end()};
}

std::string ParametersFor(std::string_view columns) {
  std::string parameters = "(?1";
  for (int i = 2; i < 2 + std::ranges::count(columns, ','); ++i) {
    parameters += ", ?" + std::to_string(i);
  }
  return parameters + ")";
}

Result<SqliteTransaction> SqliteTransaction::Begin(SqliteDatabase& database, Kind kind) {
  // IMMEDIATE takes the write lock at once. A transaction that reads first and writes later fails
  // with SQLITE_BUSY, without a wait, if another one has written in between.
  MAPLOC_RETURN_IF_ERROR(
      database.Execute(kind == Kind::kWrite ? "BEGIN IMMEDIATE" : "BEGIN DEFERRED"));
  return SqliteTransaction(database);
}

SqliteTransaction::SqliteTransaction(SqliteTransaction&& other) noexcept
    : database_(std::exchange(other.database_, nullptr)) {}

SqliteTransaction::~SqliteTransaction() {
  // A failure here means that SQLite has rolled back by itself.
  if (database_ != nullptr) static_cast<void>(database_->Execute("ROLLBACK"));
}

Status SqliteTransaction::Commit() {
  MAPLOC_RETURN_IF_ERROR(database_->Execute("COMMIT"));
  // Only after success: a COMMIT that fails leaves the transaction open, and the destructor rolls
  // it back.
  database_ = nullptr;
  return Status::Ok();
}

}  // namespace maploc
