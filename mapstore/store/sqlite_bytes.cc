#include "mapstore/store/sqlite_bytes.h"

#include <filesystem>
#include <memory>
#include <vector>

#include <sqlite3.h>

namespace maploc {
namespace {

struct FreeName {
  void operator()(const char* name) const { sqlite3_free_filename(name); }
};

// SQLite's file layer wants a name that SQLite itself has made, and memory of its own size.
class VfsFile {
 public:
  explicit VfsFile(const std::string& path)
      : vfs_(sqlite3_vfs_find(nullptr)),
        name_(sqlite3_create_filename(path.c_str(), "", "", 0, nullptr)),
        memory_(static_cast<std::size_t>(vfs_->szOsFile) / sizeof(std::max_align_t) + 1) {
    constexpr int kFlags = SQLITE_OPEN_READONLY | SQLITE_OPEN_MAIN_DB;
    open_ = vfs_->xOpen(vfs_, name_.get(), file(), kFlags, nullptr) == SQLITE_OK;
  }
  ~VfsFile() {
    // SQLite's rule: unless pMethods is null, xClose must be called, even if xOpen failed.
    if (file()->pMethods != nullptr) file()->pMethods->xClose(file());
  }
  VfsFile(const VfsFile&) = delete;
  VfsFile& operator=(const VfsFile&) = delete;

  // Beyond the file's end there are zeros.
  bool Read(std::span<unsigned char> bytes) {
    if (!open_) return false;
    const int size = static_cast<int>(bytes.size());
    const int result = file()->pMethods->xRead(file(), bytes.data(), size, 0);
    return result == SQLITE_OK || result == SQLITE_IOERR_SHORT_READ;
  }

 private:
  sqlite3_file* file() { return reinterpret_cast<sqlite3_file*>(memory_.data()); }

  sqlite3_vfs* const vfs_;
  const std::unique_ptr<const char, FreeName> name_;
  std::vector<std::max_align_t> memory_;  // zeroed
  bool open_ = false;
};

}  // namespace

Status ReadFirstBytes(const std::string& path, std::span<unsigned char> bytes) {
  // This may be the process's first call of SQLite.
  if (const int result = sqlite3_initialize(); result != SQLITE_OK) {
    return Internal(std::string("SQLite does not start: ") + sqlite3_errstr(result));
  }
  // By its real name, as connections have it: SQLite does not follow links here.
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(path, error);
  if (!error && VfsFile(real.string()).Read(bytes)) return Status::Ok();
  return Status(StatusCode::kUnavailable, "STORE_NOT_READABLE",
                path + ": cannot be read; check its permissions");
}

}  // namespace maploc
