#include "mapstore/store/serve_lock.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "mapstore/store/beside_store.h"

namespace maploc {
namespace {

// The store as the user names it; its lock lies beside the file, which may be behind a link.
Status CannotLock(const std::string& store, const std::string& lock, int error,
                  const std::string& what, const std::string& cure) {
  return Status(
      StatusCode::kUnavailable, "CANNOT_LOCK",
      store + ": its lock " + lock + " " + what + " (" + std::strerror(error) + "); " + cure);
}

}  // namespace

Result<ServeLock> ServeLock::Acquire(const std::string& store_path) {
  const std::string path = BesideStore(store_path, "-server");
  ServeLock lock(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  if (lock.file_ < 0) {
    return CannotLock(store_path, path, errno, "cannot be opened",
                      "the store's folder must exist, and this program be allowed to write in it");
  }
  // A lock of an open file description, so that two servers in one process exclude each other too.
  // A length of 0 covers the whole file.
  struct flock whole_file {};
  whole_file.l_type = F_WRLCK;
  whole_file.l_whence = SEEK_SET;
  if (fcntl(lock.file_, F_OFD_SETLK, &whole_file) == 0) return lock;
  // POSIX allows both numbers for a lock that another holds.
  if (errno == EAGAIN || errno == EACCES) {
    return Status(StatusCode::kUnavailable, "STORE_IN_USE",
                  store_path +
                      ": another maploc-server serves this store; stop it, or give this "
                      "one a store of its own");
  }
  return CannotLock(store_path, path, errno, "cannot be locked",
                    "put the store on a file system that has locks");
}

ServeLock::~ServeLock() {
  if (file_ >= 0) close(file_);
}

}  // namespace maploc
