#include "mapstore/store/sqlite_stamp.h"

#include <random>

namespace maploc {
namespace {

constexpr int kNoWait = 0;

std::int64_t NewStamp() {
  std::random_device device;
  // At most 2^61, so that one more for every transaction never overflows in practice.
  std::uniform_int_distribution<std::int64_t> any(kLeastStamp, kLeastStamp << 5);
  return any(device);
}

Status WriteStamp(SqliteDatabase& database, const std::string& insert) {
  MAPLOC_ASSIGN_OR_RETURN(auto transaction,
                          SqliteTransaction::Begin(database, SqliteTransaction::Kind::kWrite));
  SqliteStatement statement(database, insert + " INTO meta VALUES (?1, ?2)");
  MAPLOC_RETURN_IF_ERROR(statement.Bind(kStampName, NewStamp()).Run());
  return transaction.Commit();
}

}  // namespace

Result<std::optional<std::int64_t>> ReadStamp(SqliteDatabase& database) {
  SqliteStatement statement(database, "SELECT value FROM meta WHERE name = ?1");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, statement.Bind(kStampName).Step());
  if (!found) return std::optional<std::int64_t>();
  return std::optional<std::int64_t>(statement.Int("value"));
}

Status EnsureStamp(SqliteDatabase& database) {
  MAPLOC_ASSIGN_OR_RETURN(const std::optional<std::int64_t> stamp, ReadStamp(database));
  if (stamp) return Status::Ok();
  // IGNORE: if another process does the same at this moment, the first stamp stays.
  MAPLOC_RETURN_IF_ERROR(WriteStamp(database, "INSERT OR IGNORE"));
  // Into the main file, where a later look at the file alone finds it. Another process's reader may
  // keep it in the log for now.
  return database.Execute("PRAGMA wal_checkpoint(PASSIVE)");
}

Status RenewStamp(SqliteDatabase& database) { return WriteStamp(database, "INSERT OR REPLACE"); }

Status RaiseStamp(SqliteDatabase& database) {
  SqliteStatement raise(database, "UPDATE meta SET value = value + 1 WHERE name = ?1");
  return raise.Bind(kStampName).Run();
}

Result<StampInFile> ReadStampInFile(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(SqliteDatabase file,
                          SqliteDatabase::Open(path, SqliteAccess::kFileAlone, kNoWait));
  SqliteStatement page(file, "SELECT rootpage FROM sqlite_schema WHERE name = 'meta'");
  MAPLOC_ASSIGN_OR_RETURN(const bool found, page.Step());
  if (!found) return NotAStore(path, "has no table 'meta'");
  StampInFile result;
  result.page = page.Int("rootpage");
  MAPLOC_ASSIGN_OR_RETURN(result.stamp, ReadStamp(file));
  return result;
}

}  // namespace maploc
