// Whether another program has changed a store's file, for whoever reads it without locks.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace maploc {

struct FileState {
  // Of the file at `path`, behind links; nullopt where there is none.
  static std::optional<FileState> Of(const std::string& path);

  // Of owner and permissions nothing: they change no content.
  bool operator==(const FileState&) const = default;

  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t size_bytes = 0;
  std::int64_t changed_s = 0;  // the last change of its content
  std::int64_t changed_ns = 0;
  bool has_log = false;  // a log beside it that is not empty: its owner has changed the store
};

}  // namespace maploc
