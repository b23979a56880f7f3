#include "mapstore/store/sqlite_space.h"

#include <chrono>
#include <thread>

namespace maploc {
namespace {

// SQLite's number of the mode that gives pages back when it is told to.
constexpr std::int64_t kIncremental = 2;

// A MB a transaction: some milliseconds.
constexpr char kGiveSome[] = "PRAGMA incremental_vacuum(256)";

Result<bool> HasSpaceToGive(SqliteDatabase& database) {
  SqliteStatement mode(database, "PRAGMA auto_vacuum");
  MAPLOC_ASSIGN_OR_RETURN(const bool has_mode, mode.Step());
  if (!has_mode || mode.Int("auto_vacuum") != kIncremental) return false;
  SqliteStatement free(database, "PRAGMA freelist_count");
  MAPLOC_ASSIGN_OR_RETURN(const bool has_count, free.Step());
  return has_count && free.Int("freelist_count") > 0;
}

// False: there is nothing more to give.
Result<bool> GiveSome(SqliteConnections& connections) {
  MAPLOC_ASSIGN_OR_RETURN(auto writer, connections.Write());
  MAPLOC_ASSIGN_OR_RETURN(const bool more, HasSpaceToGive(writer.database()));
  if (!more) return false;
  MAPLOC_RETURN_IF_ERROR(writer.database().Execute(kGiveSome));
  MAPLOC_RETURN_IF_ERROR(writer.Commit());
  return true;
}

}  // namespace

Status GiveSpaceBack(SqliteConnections& connections) {
  while (true) {
    const auto start = std::chrono::steady_clock::now();
    MAPLOC_ASSIGN_OR_RETURN(const bool more, GiveSome(connections));
    if (!more) break;
    // Another process polls for the lock: half of the time it shall find it free.
    std::this_thread::sleep_for(std::chrono::steady_clock::now() - start);
  }
  connections.FoldWholeLog();  // only then is the file shorter
  return Status::Ok();
}

// Without a write-ahead log, because the rewritten pages would stand in it, and a crash would leave
// a log that does not look like the file's own (sqlite_log.h). The log is turned on again by the
// caller.
void MakeShrinkable(SqliteDatabase& database) {
  if (!database.Execute("PRAGMA journal_mode = DELETE").ok()) return;
  static_cast<void>(database.Execute("PRAGMA auto_vacuum = INCREMENTAL; VACUUM"));
}

}  // namespace maploc
