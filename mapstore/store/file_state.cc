#include "mapstore/store/file_state.h"

#include <filesystem>

#include <sys/stat.h>

#include "mapstore/store/beside_store.h"

namespace maploc {

std::optional<FileState> FileState::Of(const std::string& path) {
  struct stat file {};
  if (stat(path.c_str(), &file) != 0) return std::nullopt;
  FileState state;
  state.device = file.st_dev;
  state.inode = file.st_ino;
  state.size_bytes = file.st_size;
  // Not st_ctim, which also changes with the owner and the permissions.
  state.changed_s = file.st_mtim.tv_sec;
  state.changed_ns = file.st_mtim.tv_nsec;
  // An empty log holds no transaction, so the file alone is still the whole store.
  std::error_code none;
  const auto log_bytes = std::filesystem::file_size(BesideStore(path, "-wal"), none);
  state.has_log = !none && log_bytes > 0;
  return state;
}

}  // namespace maploc
