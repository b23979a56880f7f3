#include "mapstore/store/import_lock.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "mapstore/store/beside_store.h"

namespace maploc {
namespace {

std::string LockPath(const std::string& store_path) { return BesideStore(store_path, "-imports"); }

// fcntl takes a length of 0 as everything from the start on, however long the file becomes.
constexpr std::int64_t kToTheEnd = 0;

// `count` bytes from `first`. An open file description's lock, not a process's: two imports in one
// process see each other, and closing some other descriptor of the file does not let it go.
struct flock LockOf(std::int64_t first, std::int64_t count) {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = first;
  lock.l_len = count;
  return lock;
}

Status Failed(const std::string& store_path) {
  const int error = errno;
  return Status(StatusCode::kUnavailable, "IMPORT_LOCK",
                store_path + ": its lock " + LockPath(store_path) + " cannot be taken (" +
                    std::strerror(error) + "); check that file's permissions");
}

}  // namespace

Result<ImportLock> ImportLock::Acquire(const std::string& store_path, std::int64_t import_id) {
  const std::string path = LockPath(store_path);
  ImportLock lock(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  if (lock.file_ < 0) return Failed(store_path);
  // A lock may lie beyond the end of a file, so the file stays empty.
  struct flock byte = LockOf(import_id, 1);
  if (fcntl(lock.file_, F_OFD_SETLK, &byte) != 0) return Failed(store_path);
  return lock;
}

Result<bool> ImportLock::IsHeld(const std::string& store_path, std::int64_t import_id) {
  return AreHeld(store_path, import_id, 1);
}

Result<bool> ImportLock::IsAnyHeld(const std::string& store_path) {
  return AreHeld(store_path, 0, kToTheEnd);
}

Result<bool> ImportLock::AreHeld(const std::string& store_path, std::int64_t first,
                                 std::int64_t count) {
  const std::string path = LockPath(store_path);
  const ImportLock file(open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (file.file_ < 0) {
    // The first import creates the file, so there has been none yet.
    if (errno == ENOENT) return false;
    return Failed(store_path);
  }
  struct flock byte = LockOf(first, count);
  if (fcntl(file.file_, F_OFD_GETLK, &byte) != 0) return Failed(store_path);
  return byte.l_type != F_UNLCK;
}

ImportLock::~ImportLock() {
  if (file_ >= 0) close(file_);
}

}  // namespace maploc
