// A store's connections: one that writes, behind a mutex, and some that read, each used by one
// thread at a time. With write-ahead logging no reader waits for the writer. Thread-safe.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/store/sqlite_database.h"
#include "mapstore/store/sqlite_store.h"

namespace maploc {

class SqliteConnections {
 public:
  // Exclusive use of a connection while it lives, in one transaction that sees one state.
  class Reader {
   public:
    Reader(Reader&&) noexcept = default;
    ~Reader();
    SqliteDatabase& database() { return *database_; }

   private:
    friend class SqliteConnections;
    explicit Reader(SqliteConnections& owner) : owner_(&owner) {}

    SqliteConnections* owner_;
    std::unique_ptr<SqliteDatabase> database_;
    std::unique_ptr<SqliteTransaction> transaction_;
  };

  // Exclusive use of the writing connection, in a transaction that must be committed.
  class Writer {
   public:
    Writer(Writer&&) noexcept = default;
    SqliteDatabase& database() { return *database_; }
    Status Commit() { return transaction_->Commit(); }
    // Commits a change that the caches of other processes must see.
    Status CommitVisibly();

   private:
    friend class SqliteConnections;
    explicit Writer(SqliteConnections& owner)
        : lock_(owner.write_mutex_), database_(&owner.writer_) {}

    std::unique_lock<std::mutex> lock_;  // first, so that it is let go last
    SqliteDatabase* database_;
    std::unique_ptr<SqliteTransaction> transaction_;
  };

  static Result<std::unique_ptr<SqliteConnections>> Open(const std::string& path,
                                                         const SqliteStoreOptions& options);

  const std::string& path() const { return writer_.path(); }
  const SqliteStoreOptions& options() const { return options_; }
  Result<Reader> Read();
  Result<Writer> Write();

 private:
  SqliteConnections(SqliteDatabase writer, const SqliteStoreOptions& options)
      : options_(options), writer_(std::move(writer)) {}

  Result<std::unique_ptr<SqliteDatabase>> TakeReader();
  void GiveBack(std::unique_ptr<SqliteDatabase> database);

  const SqliteStoreOptions options_;
  std::mutex write_mutex_;
  SqliteDatabase writer_;  // guarded by write_mutex_

  std::mutex read_mutex_;
  std::condition_variable reader_free_;
  int readers_ = 0;                                            // guarded by read_mutex_
  std::vector<std::unique_ptr<SqliteDatabase>> free_readers_;  // guarded by read_mutex_
};

}  // namespace maploc
