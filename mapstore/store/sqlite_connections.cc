#include "mapstore/store/sqlite_connections.h"

#include "mapstore/store/sqlite_file.h"

namespace maploc {
namespace {

// Reads are short but for a map's loading; more connections than this would only cost memory.
constexpr int kMaxReaders = 8;

}  // namespace

SqliteConnections::Reader::~Reader() {
  transaction_.reset();
  if (database_) owner_->GiveBack(std::move(database_));
}

Status SqliteConnections::Writer::CommitVisibly() {
  MAPLOC_RETURN_IF_ERROR(
      database_->Execute("UPDATE meta SET value = value + 1 WHERE name = 'change_counter'"));
  return Commit();
}

Result<std::unique_ptr<SqliteConnections>> SqliteConnections::Open(
    const std::string& path, const SqliteStoreOptions& options) {
  MAPLOC_ASSIGN_OR_RETURN(SqliteDatabase writer, OpenStoreFile(path, options));
  return std::unique_ptr<SqliteConnections>(new SqliteConnections(std::move(writer), options));
}

Result<SqliteConnections::Reader> SqliteConnections::Read() {
  Reader reader(*this);
  MAPLOC_ASSIGN_OR_RETURN(reader.database_, TakeReader());
  MAPLOC_ASSIGN_OR_RETURN(
      SqliteTransaction transaction,
      SqliteTransaction::Begin(*reader.database_, SqliteTransaction::Kind::kRead));
  reader.transaction_ = std::make_unique<SqliteTransaction>(std::move(transaction));
  return reader;
}

Result<SqliteConnections::Writer> SqliteConnections::Write() {
  Writer writer(*this);
  MAPLOC_ASSIGN_OR_RETURN(
      SqliteTransaction transaction,
      SqliteTransaction::Begin(*writer.database_, SqliteTransaction::Kind::kWrite));
  writer.transaction_ = std::make_unique<SqliteTransaction>(std::move(transaction));
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
  MAPLOC_ASSIGN_OR_RETURN(SqliteDatabase database, SqliteDatabase::Open(path(), SqliteAccess::kRead,
                                                                        options_.busy_timeout_ms));
  ++readers_;
  return std::make_unique<SqliteDatabase>(std::move(database));
}

void SqliteConnections::GiveBack(std::unique_ptr<SqliteDatabase> database) {
  const std::lock_guard lock(read_mutex_);
  free_readers_.push_back(std::move(database));
  reader_free_.notify_one();
}

}  // namespace maploc
