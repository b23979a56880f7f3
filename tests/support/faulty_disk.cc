// Preloaded into a server (LD_PRELOAD) it makes the file system under $MAPLOC_FAULTY_FOLDER fail
// while $MAPLOC_FAULTY_FOLDER.errno exists, whose content is the number of the error: what is
// written, lengthened or opened for writing there fails with it, what is read does not. A disk that
// turns read-only under open files cannot be had otherwise: the kernel does it by itself after an
// error (errors=remount-ro), but refuses a remount while anything is open for writing (EBUSY).
// Each write to the file $MAPLOC_SLOW_FILE takes 0.3 ms more, as on a busy disk.
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

const char* Folder() { return std::getenv("MAPLOC_FAULTY_FOLDER"); }

// System calls alone: the functions that would do it are those below. 0: no fault.
int Fault() {
  if (Folder() == nullptr) return 0;
  const std::string path = std::string(Folder()) + ".errno";
  const int file = static_cast<int>(syscall(SYS_openat, AT_FDCWD, path.c_str(), O_RDONLY, 0));
  if (file < 0) return 0;
  char text[16] = {};
  const long size = syscall(SYS_read, file, text, sizeof(text) - 1);
  syscall(SYS_close, file);
  return size > 0 ? std::atoi(text) : 0;
}

int FaultOf(const char* path) {
  const int fault = Fault();
  return fault != 0 && std::string_view(path).starts_with(Folder()) ? fault : 0;
}

std::string PathOf(int descriptor) {
  char path[4096] = {};
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  return readlink(link.c_str(), path, sizeof(path) - 1) > 0 ? path : "";
}

int FaultOf(int descriptor) { return FaultOf(PathOf(descriptor).c_str()); }

void WaitIfSlow(int descriptor) {
  const char* slow = std::getenv("MAPLOC_SLOW_FILE");
  if (slow != nullptr && PathOf(descriptor) == slow) usleep(300);
}

}  // namespace

// The functions that SQLite changes files with.
extern "C" {

ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t at) {
  if (const int fault = FaultOf(file)) return errno = fault, -1;
  WaitIfSlow(file);
  return syscall(SYS_pwrite64, file, bytes, size, at);
}

int ftruncate64(int file, off64_t size) noexcept {
  if (const int fault = FaultOf(file)) return errno = fault, -1;
  return static_cast<int>(syscall(SYS_ftruncate, file, size));
}

int unlink(const char* path) noexcept {
  const int fault = FaultOf(path);
  if (fault == EROFS) return errno = fault, -1;
  return static_cast<int>(syscall(SYS_unlinkat, AT_FDCWD, path, 0));
}

int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  struct stat there {};
  const bool makes = (flags & O_CREAT) != 0 && stat(path, &there) != 0;
  const int fault = FaultOf(path);
  if (fault != 0 && (makes || (fault == EROFS && (flags & O_ACCMODE) != O_RDONLY))) {
    return errno = fault, -1;
  }
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

}  // extern "C"
