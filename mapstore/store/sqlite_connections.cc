#include "mapstore/store/sqlite_connections.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include <sqlite3.h>

#include "mapstore/base/wait_limit.h"
#include "mapstore/store/sqlite_file.h"
#include "mapstore/store/sqlite_stamp.h"

namespace maploc {
namespace {

// Reads are short but for a map's loading; more connections than this would only cost memory.
constexpr int kMaxReaders = 8;

// As SQLite's own default: some 4 MB.
constexpr int kFoldLogAtPages = 1000;

// After a fold the file counts as changed until its clock has ticked (sqlite_identity.cc).
constexpr std::chrono::milliseconds kFileSettles{30};

int CountLogPages(void* count, sqlite3*, const char*, int pages) {
  *static_cast<int*>(count) = pages;
  return SQLITE_OK;
}

// The last connection that closes would write the log into the file.
void LeaveLogAtClose(SqliteDatabase& database) {
  sqlite3_db_config(database.handle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
}

}  // namespace

SqliteConnections::Reader::~Reader() {
  transaction_.reset();
  if (database_) owner_->GiveBack(std::move(database_));
}

Status SqliteConnections::Writer::Commit() {
  // Every transaction writes the stamp, so that each log that is not empty can be compared with the
  // file (FORMAT.md, "The stamp").
  MAPLOC_RETURN_IF_ERROR(RaiseStamp(*database_));
  MAPLOC_RETURN_IF_ERROR(owner_->identity_->Check(*database_));
  MAPLOC_RETURN_IF_ERROR(transaction_->Commit());
  // If the file was moved before the commit, the transaction went into the old file and would be
  // lost. The caller must not report it as stored.
  MAPLOC_RETURN_IF_ERROR(owner_->identity_->CheckPaths());
  owner_->FoldLog(kFoldLogAtPages);
  return Status::Ok();
}

Status SqliteConnections::Writer::CommitVisibly() {
  MAPLOC_RETURN_IF_ERROR(
      database_->Execute("UPDATE meta SET value = value + 1 WHERE name = 'change_counter'"));
  return Commit();
}

Result<std::unique_ptr<SqliteConnections>> SqliteConnections::Open(
    const std::string& path, const SqliteStoreOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(SqliteDatabase writer, OpenStoreFile(path, options));
  std::unique_ptr<SqliteIdentity> identity;
  if (writer.access() != SqliteAccess::kFileAlone) {
    MAPLOC_ASSIGN_OR_RETURN(identity, SqliteIdentity::Of(writer));
  }
  return std::unique_ptr<SqliteConnections>(
      new SqliteConnections(std::move(writer), std::move(identity), options));
}

SqliteConnections::SqliteConnections(SqliteDatabase writer,
                                     std::unique_ptr<SqliteIdentity> identity,
                                     const SqliteStoreOptions& options)
    : options_(options), writer_(std::move(writer)), identity_(std::move(identity)) {
  // In place of SQLite's own folding of the log at a commit, which does not look whose file it is.
  sqlite3_wal_hook(writer_.handle(), &CountLogPages, &log_pages_);
}

SqliteConnections::~SqliteConnections() {
  if (read_only()) return;
  // A last look at the identity, which also decides below whether closing may write the log into
  // the file.
  static_cast<void>(Read());
  if (identity_->state() == SqliteIdentity::State::kGood) return;
  LeaveLogAtClose(writer_);
  for (const std::unique_ptr<SqliteDatabase>& reader : free_readers_) LeaveLogAtClose(*reader);
}

// Only into a file of which a transaction has seen that it is ours. Where another process has
// folded the log meanwhile, the next commit looks again and folds.
void SqliteConnections::FoldLog(int at_pages) {
  if (log_pages_ < at_pages || !identity_->IsUnchanged()) return;
  // A file with half a checkpoint in it would look like a damaged or foreign one.
  const auto no_looks = identity_->HoldLooks();
  // What cannot be folded now stays in the log, and the next commit tries again.
  static_cast<void>(writer_.Execute("PRAGMA wal_checkpoint(PASSIVE)"));
}

void SqliteConnections::FoldWholeLog() {
  if (read_only()) return;
  std::this_thread::sleep_for(kFileSettles);
  static_cast<void>(Read());  // a look: FoldLog asks for an unchanged file
  const std::lock_guard lock(write_mutex_);
  FoldLog(1);
}

// The store's file was moved or deleted, but its log is still at the old path, where the next
// program would replay it into the file that is there now. So the log is written into its own file,
// which is still open. If that file was only moved, it is complete afterwards. While somebody still
// reads, the log stays, and the next refused read or write tries again.
void SqliteConnections::FoldLogOfMovedStore() {
  if (read_only() || folded_ || identity_->state() != SqliteIdentity::State::kMoved) return;
  const WaitLimit no_wait(std::chrono::steady_clock::now());
  // Not the PRAGMA: it succeeds where it was held up.
  folded_ = sqlite3_wal_checkpoint_v2(writer_.handle(), nullptr, SQLITE_CHECKPOINT_TRUNCATE,
                                      nullptr, nullptr) == SQLITE_OK;
}

Deadline SqliteConnections::LatestStart() const {
  const auto timeout = std::chrono::milliseconds(options_.busy_timeout_ms);
  return std::min(WaitLimit::CurrentDeadline(), std::chrono::steady_clock::now() + timeout);
}

Result<SqliteConnections::Reader> SqliteConnections::Read() {
  Reader reader(*this);
  Status status = Begin(reader);
  if (status.ok()) return reader;
  reader.transaction_.reset();
  // Only if no writer is at work: a read never waits for the writer.
  if (const std::unique_lock lock(write_mutex_, std::try_to_lock); lock) FoldLogOfMovedStore();
  return status;
}

Status SqliteConnections::Begin(Reader& reader) {
  MAPLOC_RETURN_IF_ERROR(CheckIdentity());
  MAPLOC_ASSIGN_OR_RETURN(reader.database_, TakeReader());
  MAPLOC_ASSIGN_OR_RETURN(
      SqliteTransaction transaction,
      SqliteTransaction::Begin(*reader.database_, SqliteTransaction::Kind::kRead));
  reader.transaction_ = std::make_unique<SqliteTransaction>(std::move(transaction));
  // Inside the transaction, because this check compares the file's stamp with the one that the
  // transaction sees.
  return identity_ ? identity_->Check(*reader.database_) : Status::Ok();
}

Result<SqliteConnections::Writer> SqliteConnections::Write() {
  if (read_only()) {
    return FailedPrecondition("STORE_READ_ONLY",
                              path() +
                                  ": the store may only be read, so nothing can be kept (the "
                                  "file, its folder or its disk is read-only for this user)");
  }
  Writer writer(*this);
  if (!writer.lock_) {
    return Status(StatusCode::kUnavailable, "STORE_BUSY",
                  path() + ": others wait to write into the store; try again");
  }
  // Before the transaction begins, because SQLite refuses a checkpoint inside one.
  if (const Status status = identity_->CheckPaths(); !status.ok()) {
    FoldLogOfMovedStore();
    return status;
  }
  MAPLOC_ASSIGN_OR_RETURN(
      SqliteTransaction transaction,
      SqliteTransaction::Begin(*writer.database_, SqliteTransaction::Kind::kWrite));
  writer.transaction_ = std::make_unique<SqliteTransaction>(std::move(transaction));
  MAPLOC_RETURN_IF_ERROR(identity_->Check(*writer.database_));
  return writer;
}

Result<std::unique_ptr<SqliteDatabase>> SqliteConnections::TakeReader() {
  std::unique_lock lock(read_mutex_);
  reader_free_.wait(lock, [this] { return !free_readers_.empty() || readers_ < kMaxReaders; });
  if (!free_readers_.empty()) {
    std::unique_ptr<SqliteDatabase> database = std::move(free_readers_.back());
    free_readers_.pop_back();
    return database;
  }
  const SqliteAccess access = read_only() ? writer_.access() : SqliteAccess::kRead;
  MAPLOC_ASSIGN_OR_RETURN(SqliteDatabase database,
                          SqliteDatabase::Open(path(), access, options_.busy_timeout_ms));
  // Else it may be a connection to another file.
  MAPLOC_RETURN_IF_ERROR(CheckIdentity());
  ++readers_;
  return std::make_unique<SqliteDatabase>(std::move(database));
}

void SqliteConnections::GiveBack(std::unique_ptr<SqliteDatabase> database) {
  const std::lock_guard lock(read_mutex_);
  free_readers_.push_back(std::move(database));
  reader_free_.notify_one();
}

}  // namespace maploc
