// Says that an import lives: a lock on one byte of a file beside the store, which the kernel lets
// go when the process dies, however it dies. Unlike a process id it cannot be reused, and it holds
// across containers that share the folder. The file is STORE-imports, of the path without links.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "mapstore/base/status.h"

namespace maploc {

// Holds the lock of one import while it lives.
class ImportLock {
 public:
  // REQUIRES: nobody holds it (import ids are never given twice).
  static Result<ImportLock> Acquire(const std::string& store_path, std::int64_t import_id);
  // Whether anybody, this process included, holds it.
  static Result<bool> IsHeld(const std::string& store_path, std::int64_t import_id);
  // Whether any import holds one.
  static Result<bool> IsAnyHeld(const std::string& store_path);

  ImportLock(ImportLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  ImportLock& operator=(ImportLock&&) = delete;
  ~ImportLock();

 private:
  static Result<bool> AreHeld(const std::string& store_path, std::int64_t first,
                              std::int64_t count);
  explicit ImportLock(int file) : file_(file) {}

  int file_;
};

}  // namespace maploc
