#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "mapstore/store/beside_store.h"
#include "mapstore/store/import_lock.h"
#include "mapstore/store/restore.h"
#include "mapstore/store/serve_lock.h"
#include "mapstore/store/sqlite_backup.h"
#include "mapstore/store/sqlite_file.h"
#include "mapstore/store/sqlite_store.h"

namespace maploc {
namespace {

namespace fs = std::filesystem;

constexpr int kBusyTimeoutMs = 10000;

Status InUse(const std::string& store, const std::string& who) {
  return Status(StatusCode::kUnavailable, "STORE_IN_USE",
                store + ": " + who + "; end it first, then restore");
}

// Where a store goes: the path that the user gave, and the file behind it, if that is a link.
struct Place {
  std::string given;
  std::string file;
};

Status Failed(const Place& store, const std::string& what) {
  return Status(StatusCode::kUnavailable, "RESTORE_FAILED",
                store.given + ": " + what + " cannot be put in place (" + std::strerror(errno) +
                    "); the store is as it was; check the folder and its permissions");
}

// Held until the new file is in place, so that no server starts on the old one meanwhile.
Result<ServeLock> LockOut(const std::string& store) {
  Result<ServeLock> lock = ServeLock::Acquire(store);
  if (lock.status().reason() == "STORE_IN_USE") return InUse(store, "a maploc-server serves it");
  if (!lock.ok()) return lock.status();
  MAPLOC_ASSIGN_OR_RETURN(const bool importing, ImportLock::IsAnyHeld(store));
  if (importing) return InUse(store, "an import into it runs");
  return lock;
}

// Without a log a backup is read as it lies there, also from a medium that cannot be written.
Result<SqliteDatabase> OpenSource(const std::string& from) {
  MAPLOC_RETURN_IF_ERROR(CheckStoreFile(from));
  std::error_code none;
  // The log lies beside the file itself, which `from` may name by a link.
  const auto log_bytes = fs::file_size(BesideStore(from, "-wal"), none);
  const bool has_log = !none && log_bytes > 0;
  return SqliteDatabase::Open(from, has_log ? SqliteAccess::kRead : SqliteAccess::kFileAlone,
                              kBusyTimeoutMs);
}

Status BringUpToDateAndVerify(const std::string& path) {
  SqliteStoreOptions options;
  options.create = false;
  MAPLOC_ASSIGN_OR_RETURN(const auto store, OpenSqliteStore(path, options));
  return store->Verify();
}

Result<RestoredStore> CountWhatIsIn(const std::string& path) {
  // The store is closed again, so its log is in the file and nothing needs to appear beside it.
  MAPLOC_ASSIGN_OR_RETURN(SqliteDatabase database,
                          SqliteDatabase::Open(path, SqliteAccess::kFileAlone, kBusyTimeoutMs));
  SqliteStatement count(database,
                        "SELECT COUNT(DISTINCT name) AS maps, COUNT(*) AS versions, (SELECT "
                        "COUNT(*) FROM sessions) AS sessions "
                        "FROM map_versions WHERE state = 1 AND deleted = 0");
  MAPLOC_ASSIGN_OR_RETURN(const bool row, count.Step());
  if (!row) return Internal(path + ": counts nothing");
  return RestoredStore{count.Int("maps"), count.Int("versions"), count.Int("sessions")};
}

// With the owner and the permissions of the file that it replaces: a restore by root must not shut
// the server out.
Status Settle(const std::string& partial, const Place& store) {
  struct stat old {};
  if (stat(store.file.c_str(), &old) == 0) {
    const bool like_old = chown(partial.c_str(), old.st_uid, old.st_gid) == 0 &&
                          chmod(partial.c_str(), old.st_mode & 07777) == 0;
    if (!like_old) return Failed(store, partial);
  }
  // On disk before the rename, so that after a power failure the store's name has a complete file.
  const int file = open(partial.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  if (file >= 0) close(file);
  return synced ? Status::Ok() : Failed(store, partial);
}

// Keeps the old store under other names until the new one is in place. Its file and logs keep
// matching names, so that they are one store for SQLite: if this process is killed meanwhile,
// nothing is lost.
class OldStore {
 public:
  explicit OldStore(const Place& place)
      : place_(place), path_(place.file), aside_(path_ + ".replaced-" + std::to_string(getpid())) {}

  // The logs too: one beside the new file would be replayed into it.
  Status SetAside() {
    if (fs::exists(path_) && !GiveSecondName()) return Failed(place_, path_);
    for (const char* suffix : {"-wal", "-shm", "-journal"}) {
      if (std::rename((path_ + suffix).c_str(), (aside_ + suffix).c_str()) == 0) {
        moved_.emplace_back(suffix);
      } else if (errno != ENOENT) {
        const Status failed = Failed(place_, path_ + suffix);
        PutBack();
        return failed;
      }
    }
    return Status::Ok();
  }
  void PutBack() const {
    for (const std::string& suffix : moved_) {
      std::rename((aside_ + suffix).c_str(), (path_ + suffix).c_str());
    }
    // If both names are the same file, rename() does nothing and the second name is removed below.
    // Otherwise it brings the old file back.
    std::rename(aside_.c_str(), path_.c_str());
    std::remove(aside_.c_str());
  }
  void Discard() const { RemoveStoreFiles(aside_); }

 private:
  // By a link the file keeps its own name as well, so that there is a store at every moment. On
  // file systems without links the path is empty until the new file is in place; if this process is
  // killed in between, the old file and its logs are under the other name.
  bool GiveSecondName() const {
    if (link(path_.c_str(), aside_.c_str()) == 0) return true;
    return HasNoLinks(errno) && std::rename(path_.c_str(), aside_.c_str()) == 0;
  }

  const Place place_;
  const std::string path_;
  const std::string aside_;
  std::vector<std::string> moved_;
};

Status PutInPlace(const std::string& partial, const Place& store) {
  MAPLOC_RETURN_IF_ERROR(Settle(partial, store));
  OldStore old(store);
  MAPLOC_RETURN_IF_ERROR(old.SetAside());
  if (std::rename(partial.c_str(), store.file.c_str()) != 0 || !SyncFolderOf(store.file)) {
    const Status failed = Failed(store, store.file);
    old.PutBack();
    return failed;
  }
  old.Discard();
  return Status::Ok();
}

Result<RestoredStore> Restore(const Place& store, const std::string& from,
                              const std::string& partial) {
  MAPLOC_ASSIGN_OR_RETURN(SqliteDatabase source, OpenSource(from));
  MAPLOC_RETURN_IF_ERROR(CopyStore(source, partial));
  if (const Status status = BringUpToDateAndVerify(partial); !status.ok()) {
    return status.WithContext(from + " is not restored, because its copy does not verify");
  }
  MAPLOC_ASSIGN_OR_RETURN(const RestoredStore restored, CountWhatIsIn(partial));
  MAPLOC_RETURN_IF_ERROR(PutInPlace(partial, store));
  return restored;
}

}  // namespace

Result<RestoredStore> RestoreSqliteStore(const std::string& store, const std::string& from) {
  if (store.empty()) return InvalidArgument("store", "the name is empty; name a file");
  MAPLOC_ASSIGN_OR_RETURN(const ServeLock lock, LockOut(store));
  std::error_code error;
  const fs::path real = fs::weakly_canonical(store, error);  // a link stays one
  if (error) return Failed({store, store}, store);
  if (fs::equivalent(real, from, error)) {
    return InvalidArgument("from", "is the store itself; name its backup");
  }
  const std::string partial = real.string() + ".partial-" + std::to_string(getpid());
  Result<RestoredStore> restored = Restore({store, real.string()}, from, partial);
  RemoveStoreFiles(partial);
  return restored;
}

}  // namespace maploc
