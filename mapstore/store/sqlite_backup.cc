#include "mapstore/store/sqlite_backup.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include "mapstore/store/sqlite_database.h"
#include "mapstore/store/sqlite_file.h"
#include "mapstore/store/sqlite_stamp.h"
#include "mapstore/store/sqlite_store.h"

namespace maploc {
namespace {

// All pages in one step: of one state, and without keeping writers of the source waiting, because
// it is in write-ahead logging.
Status CopyPages(SqliteDatabase& from, SqliteDatabase& to) {
  sqlite3_backup* backup = sqlite3_backup_init(to.handle(), "main", from.handle(), "main");
  if (backup == nullptr) return to.ErrorOf(sqlite3_errcode(to.handle()));
  const int result = sqlite3_backup_step(backup, -1);
  sqlite3_backup_finish(backup);
  return result == SQLITE_DONE ? Status::Ok() : to.ErrorOf(result);
}

std::filesystem::path FolderOf(const std::string& path) {
  // A bare file name has an empty parent path, which system calls refuse.
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder;
}

Status NotWritten(const std::string& to) {
  return Status(StatusCode::kUnavailable, "BACKUP_NOT_WRITTEN",
                to + ": cannot be written (" + std::strerror(errno) + "); check the folder");
}

Status FileExists(const std::string& path) {
  return Status(StatusCode::kAlreadyExists, "FILE_EXISTS",
                path + ": exists already; choose another name or remove it");
}

bool GiveName(const std::string& partial, const std::string& to) {
  if (link(partial.c_str(), to.c_str()) == 0) return true;
  return HasNoLinks(errno) && RenameToNewName(partial, to);
}

}  // namespace

Status CopyStore(SqliteDatabase& source, const std::string& to) {
  constexpr int kNobodyElseIsThere = 0;
  MAPLOC_ASSIGN_OR_RETURN(SqliteDatabase target,
                          SqliteDatabase::Open(to, SqliteAccess::kCreate, kNobodyElseIsThere));
  MAPLOC_RETURN_IF_ERROR(CopyPages(source, target));
  // A file that is read without locks may have changed between two pages.
  MAPLOC_RETURN_IF_ERROR(source.CheckUnchanged());
  // So that it cannot be taken for the store itself, nor the store's log for its own.
  return RenewStamp(target);
}

bool SyncFolderOf(const std::string& path) {
  const int descriptor = open(FolderOf(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool synced = fsync(descriptor) == 0;
  close(descriptor);
  return synced;
}

void RemoveStoreFiles(const std::string& path) {
  for (const char* suffix : {"", "-wal", "-shm", "-journal", "-imports"}) {
    std::remove((path + suffix).c_str());
  }
}

Status CheckNewStoreFile(const std::string& to) {
  std::error_code error;
  if (std::filesystem::exists(to, error)) return FileExists(to);
  // AT_EACCESS asks for the effective user, as opening a file does. access() would ask for the real
  // one.
  return faccessat(AT_FDCWD, FolderOf(to).c_str(), W_OK, AT_EACCESS) == 0 ? Status::Ok()
                                                                          : NotWritten(to);
}

bool HasNoLinks(int error) { return error == EPERM || error == EOPNOTSUPP || error == ENOSYS; }

bool RenameOverOwnFile(const std::string& from, const std::string& to) {
  // O_EXCL takes the name, so that the rename replaces nothing but the empty file that was made
  // here.
  const int own = open(to.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (own < 0) return false;
  close(own);
  if (std::rename(from.c_str(), to.c_str()) == 0) return true;
  // The caller reports the error of the rename, and remove() may overwrite it.
  const int error = errno;
  std::remove(to.c_str());
  errno = error;
  return false;
}

bool RenameToNewName(const std::string& from, const std::string& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  // EINVAL: the file system does not know RENAME_NOREPLACE. ENOSYS: the kernel does not know
  // renameat2.
  const bool unknown = errno == EINVAL || errno == ENOSYS || errno == EOPNOTSUPP;
  return unknown && RenameOverOwnFile(from, to);
}

// A link fails where the name exists by now; a plain rename would replace what is there.
Status PublishStoreFile(const std::string& partial, const std::string& to) {
  if (GiveName(partial, to) && SyncFolderOf(to)) return Status::Ok();
  return errno == EEXIST ? FileExists(to) : NotWritten(to);
}

Status BackupSqliteStore(const std::string& from, const std::string& to) {
  SqliteStoreOptions options;
  options.create = false;
  MAPLOC_ASSIGN_OR_RETURN(SqliteDatabase source, OpenStoreFile(from, options));
  // Checked first, so that the error names the path that the user gave and not that of the partial
  // file.
  MAPLOC_RETURN_IF_ERROR(CheckNewStoreFile(to));
  // The copy gets its name only when it is complete: a crash leaves no half backup that looks
  // whole.
  const std::string partial = to + ".partial-" + std::to_string(getpid());
  Status status = CopyStore(source, partial);
  if (status.ok()) status = PublishStoreFile(partial, to);
  RemoveStoreFiles(partial);
  return status;
}

}  // namespace maploc
