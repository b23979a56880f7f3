// A store's connections: one that writes, behind a mutex, and some that read, each used by one
// thread at a time. With write-ahead logging no reader waits for the writer. Thread-safe.
//
// A writer waits for another one until the busy timeout or the thread's WaitLimit, then it is
// UNAVAILABLE (STORE_BUSY).
//
// Where nothing may be written (CanWriteStore) Write is STORE_READ_ONLY.
//
// Every read and write begins, and every commit ends, with a look whether the path still names the
// store: else UNAVAILABLE (STORE_REPLACED), for good. A file that is read alone (kFileAlone) must
// have been left unchanged as well.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "mapstore/base/clock.h"
#include "mapstore/base/status.h"
#include "mapstore/store/sqlite_database.h"
#include "mapstore/store/sqlite_identity.h"
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
    // Ok: it is on disk, in the file that the path names.
    Status Commit();
    // Commits a change that the caches of other processes must see.
    Status CommitVisibly();

   private:
    friend class SqliteConnections;
    explicit Writer(SqliteConnections& owner)
        : owner_(&owner),
          lock_(owner.write_mutex_, owner.LatestStart()),
          database_(&owner.writer_) {}

    SqliteConnections* owner_;
    std::unique_lock<std::timed_mutex> lock_;  // before the transaction, so that it is let go last
    SqliteDatabase* database_;
    std::unique_ptr<SqliteTransaction> transaction_;
  };

  static Result<std::unique_ptr<SqliteConnections>> Open(const std::string& path,
                                                         const SqliteStoreOptions& options);
  ~SqliteConnections();

  const std::string& path() const { return writer_.path(); }
  const SqliteStoreOptions& options() const { return options_; }
  bool read_only() const { return writer_.IsReadOnly(); }
  Result<Reader> Read();
  Result<Writer> Write();
  // What stands in the log goes into the file now, as far as no reader needs it there.
  void FoldWholeLog();
  // Whether the path still names the store, without a look into its files: a few microseconds.
  Status CheckIdentity() { return identity_ ? identity_->CheckPaths() : writer_.CheckUnchanged(); }

 private:
  SqliteConnections(SqliteDatabase writer, std::unique_ptr<SqliteIdentity> identity,
                    const SqliteStoreOptions& options);

  // Until when a writer waits for this process's others, as for another process's.
  Deadline LatestStart() const;
  Status Begin(Reader& reader);
  // REQUIRES: write_mutex_ is held and no transaction runs (both).
  void FoldLog(int at_pages);
  void FoldLogOfMovedStore();
  Result<std::unique_ptr<SqliteDatabase>> TakeReader();
  void GiveBack(std::unique_ptr<SqliteDatabase> database);

  const SqliteStoreOptions options_;
  std::timed_mutex write_mutex_;
  SqliteDatabase writer_;  // guarded by write_mutex_
  int log_pages_ = 0;      // in the log after the last commit; guarded by write_mutex_
  bool folded_ = false;    // guarded by write_mutex_
  const std::unique_ptr<SqliteIdentity> identity_;  // null: kFileAlone

  std::mutex read_mutex_;
  std::condition_variable reader_free_;
  int readers_ = 0;                                            // guarded by read_mutex_
  std::vector<std::unique_ptr<SqliteDatabase>> free_readers_;  // guarded by read_mutex_
};

}  // namespace maploc
