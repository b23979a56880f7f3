#include "mapstore/store/sqlite_file.h"

#include <array>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>

#include <fcntl.h>
#include <unistd.h>

#include "mapstore/store/beside_store.h"
#include "mapstore/store/schema.h"
#include "mapstore/store/sqlite_bytes.h"
#include "mapstore/store/sqlite_log.h"
#include "mapstore/store/sqlite_migration.h"
#include "mapstore/store/sqlite_places.h"
#include "mapstore/store/sqlite_space.h"
#include "mapstore/store/sqlite_stamp.h"
#include "mapstore/store/sqlite_states.h"
#include "mapstore/store/sqlite_store.h"

namespace maploc {
namespace {

// SQLite's header, as its file format document gives it (big-endian fields).
constexpr std::size_t kHeaderBytes = 100;
constexpr std::size_t kUserVersionAt = 60;
constexpr std::size_t kApplicationIdAt = 68;
constexpr std::string_view kMagic("SQLite format 3\0", 16);
using Header = std::array<unsigned char, kHeaderBytes>;

std::uint32_t BigEndian32(const Header& header, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | header[at + i];
  return value;
}

Status TooNew(const std::string& path, std::int64_t version) {
  return FailedPrecondition("STORE_TOO_NEW", path + ": has schema version " +
                                                 std::to_string(version) + ", this program knows " +
                                                 std::to_string(StoreSchemaVersion()) +
                                                 "; use a newer maploc");
}

// Looks at the bytes alone: merely opening a strange database could change it (a log to be
// replayed).
Status CheckHeader(const std::string& path) {
  Header header{};
  MAPLOC_RETURN_IF_ERROR(ReadFirstBytes(path, header));
  if (std::memcmp(header.data(), kMagic.data(), kMagic.size()) != 0) {
    return NotAStore(path, "is not an SQLite database");
  }
  if (BigEndian32(header, kApplicationIdAt) != static_cast<std::uint32_t>(kStoreApplicationId)) {
    return NotAStore(path, "is an SQLite database of another application");
  }
  const std::uint32_t version = BigEndian32(header, kUserVersionAt);
  if (version > static_cast<std::uint32_t>(StoreSchemaVersion())) return TooNew(path, version);
  return Status::Ok();
}

// Whether there is a store already; an error where the path is something else.
Result<bool> CheckPath(const std::string& path, bool create) {
  if (path.empty()) return InvalidArgument("store", "the name is empty; name a file");
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    if (create) return false;
    return Status(StatusCode::kNotFound, "STORE_NOT_FOUND",
                  path + ": there is no such store; check --store, or make one by an import");
  }
  if (!std::filesystem::is_regular_file(status)) {
    return NotAStore(path, "is not a file");
  }
  if (std::filesystem::file_size(path, error) > 0) return true;
  // An empty file may be a store that another process is creating at this moment. Migrate then
  // waits for that process.
  if (create) return false;
  return NotAStore(path, "is empty; make a store by an import");
}

Result<std::int64_t> UserVersion(SqliteDatabase& database) {
  SqliteStatement statement(database, "PRAGMA user_version");
  MAPLOC_ASSIGN_OR_RETURN(const bool row, statement.Step());
  return row ? statement.Int("user_version") : 0;
}

// In one transaction, so that a store is of one version or of the next. The application id is
// written with the first, before the write-ahead log is turned on, so that CheckHeader finds it in
// the main file.
Status Migrate(SqliteDatabase& database) {
  MAPLOC_ASSIGN_OR_RETURN(auto transaction,
                          SqliteTransaction::Begin(database, SqliteTransaction::Kind::kWrite));
  // Asked again under the write lock: another process may have migrated the store meanwhile.
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t version, UserVersion(database));
  if (version > StoreSchemaVersion()) return TooNew(database.path(), version);
  if (version == StoreSchemaVersion()) return Status::Ok();
  for (std::int64_t i = version; i < StoreSchemaVersion(); ++i) {
    if (i == kVersionWithCovariances) {
      MAPLOC_RETURN_IF_ERROR(TakeCovariancesOffChecksums(database));
    }
    MAPLOC_RETURN_IF_ERROR(
        database.Execute(std::string(StoreMigrations()[static_cast<std::size_t>(i)])));
  }
  // After all migrations, because both use the columns of the newest schema.
  MAPLOC_RETURN_IF_ERROR(DeriveAllAnew(database));
  MAPLOC_RETURN_IF_ERROR(WriteMissingPlaces(database));
  // Both numbers are in the file's first page, so writing them is part of the transaction.
  MAPLOC_RETURN_IF_ERROR(
      database.Execute("PRAGMA application_id = " + std::to_string(kStoreApplicationId)));
  MAPLOC_RETURN_IF_ERROR(
      database.Execute("PRAGMA user_version = " + std::to_string(StoreSchemaVersion())));
  return transaction.Commit();
}

// SQLite does not call the busy handler while it changes the journal mode, so the wait for other
// processes is here.
Status TurnOnWriteAheadLog(SqliteDatabase& database, int busy_timeout_ms) {
  const auto give_up =
      std::chrono::steady_clock::now() + std::chrono::milliseconds(busy_timeout_ms);
  while (true) {
    const Status status = database.Execute("PRAGMA journal_mode = WAL");
    const bool late = std::chrono::steady_clock::now() >= give_up;
    if (status.code() != StatusCode::kUnavailable || late) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

// Statistics and strategies that another version of this program derived from the same rows.
Status DeriveAnewIfStale(SqliteDatabase& database) {
  MAPLOC_ASSIGN_OR_RETURN(const bool stale, IsStale(database));
  if (!stale) return Status::Ok();
  MAPLOC_ASSIGN_OR_RETURN(auto transaction,
                          SqliteTransaction::Begin(database, SqliteTransaction::Kind::kWrite));
  // Another process may have done it while this one waited for the write lock.
  MAPLOC_ASSIGN_OR_RETURN(const bool still_stale, IsStale(database));
  if (!still_stale) return Status::Ok();
  MAPLOC_RETURN_IF_ERROR(DeriveAllAnew(database));
  return transaction.Commit();
}

Status CheckBytes(const std::string& path) {
  MAPLOC_RETURN_IF_ERROR(CheckHeader(path));
  return CheckLog(path);
}

Status NotOfThisProgram(const std::string& path) {
  return FailedPrecondition("STORE_TOO_OLD",
                            path +
                                ": was written by another version of maploc, and is only read "
                                "here, so it cannot be brought up to date; copy it with `cp` to "
                                "where you may write, and open the copy once with `maploc-map list "
                                "--store COPY`");
}

// A program that has the store open has its log beside it. Without a log the file is complete, and
// CheckUnchanged notices later changes. A disk that is mounted read-only is no exception: it may be
// mounted for writing elsewhere.
SqliteAccess AccessWithoutWriting(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(BesideStore(path, "-wal"), error) ? SqliteAccess::kReadOnly
                                                                   : SqliteAccess::kFileAlone;
}

Result<SqliteDatabase> OpenWithoutWriting(const std::string& path,
                                          const SqliteStoreOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(
      SqliteDatabase database,
      SqliteDatabase::Open(path, AccessWithoutWriting(path), options.busy_timeout_ms));
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t version, UserVersion(database));
  if (version != StoreSchemaVersion()) return NotOfThisProgram(path);
  MAPLOC_ASSIGN_OR_RETURN(const bool stale, IsStale(database));
  if (stale) return NotOfThisProgram(path);
  return database;
}

}  // namespace

bool CanWriteStore(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return true;
  const std::filesystem::path real = std::filesystem::canonical(path, error);
  const auto can_write = [](const std::filesystem::path& name) {
    return faccessat(AT_FDCWD, name.c_str(), W_OK, AT_EACCESS) == 0;
  };
  // The folder too: SQLite creates the log and its index there.
  return error || (can_write(real) && can_write(real.parent_path()));
}

Status CheckStoreFile(const std::string& path) {
  MAPLOC_RETURN_IF_ERROR(CheckPath(path, /*create=*/false).status());
  return CheckBytes(path);
}

Status CheckStore(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(const bool exists, CheckPath(path, /*create=*/true));
  return exists ? CheckBytes(path) : Status::Ok();
}

Result<SqliteDatabase> OpenStoreFile(const std::string& path, const SqliteStoreOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(const bool exists, CheckPath(path, options.create));
  if (exists) MAPLOC_RETURN_IF_ERROR(CheckBytes(path));
  if (exists && (options.read_only || !CanWriteStore(path))) {
    return OpenWithoutWriting(path, options);
  }
  const SqliteAccess access = exists ? SqliteAccess::kWrite : SqliteAccess::kCreate;
  MAPLOC_ASSIGN_OR_RETURN(SqliteDatabase database,
                          SqliteDatabase::Open(path, access, options.busy_timeout_ms));
  MAPLOC_ASSIGN_OR_RETURN(const std::int64_t version, UserVersion(database));
  // Before the first table is made.
  if (version == 0) MAPLOC_RETURN_IF_ERROR(database.Execute("PRAGMA auto_vacuum = INCREMENTAL"));
  if (version != StoreSchemaVersion()) MAPLOC_RETURN_IF_ERROR(Migrate(database));
  if (version > 0 && version < kVersionShrinkable) MakeShrinkable(database);
  MAPLOC_RETURN_IF_ERROR(TurnOnWriteAheadLog(database, options.busy_timeout_ms));
  MAPLOC_RETURN_IF_ERROR(EnsureStamp(database));
  MAPLOC_RETURN_IF_ERROR(DeriveAnewIfStale(database));
  return database;
}

}  // namespace maploc
