// The recording on disk: files of records in one folder (format: proto/recording/README.md), of
// which the oldest goes where the newest needs its room. A process that is killed leaves at most a
// torn last record, which readers skip.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "mapstore/base/owned_fd.h"
#include "mapstore/base/status.h"

namespace maploc {

// Sixteen files; the largest record fits into one of two.
inline constexpr std::int64_t kMinRecorderBytes = 64 << 20;
// So much of the disk stays free for others, above all the store.
inline constexpr std::int64_t kFreeForOthers = 256 << 20;

// What makes the folder unusable, without changing anything: for --check-config. `folder` as the
// user named it.
Status CheckRecorderFolder(const std::string& folder);

// Not thread-safe.
class RecordingRing {
 public:
  // Makes the folder where it is missing (mode 0700), and holds it until the end: UNAVAILABLE
  // (RECORDER_IN_USE) where another server records there. Files of earlier runs count, and stay as
  // far as they fit. REQUIRES: max_bytes >= kMinRecorderBytes.
  static Result<RecordingRing> Open(const std::string& folder, std::int64_t max_bytes);

  // The record is in the file, or nothing of it. RESOURCE_EXHAUSTED (DISK_FULL) also where
  // kFreeForOthers would be touched; UNAVAILABLE (RECORDER_IO) otherwise. May be called again.
  Status Append(std::string_view record);

  // Of all files; never more than max_bytes.
  std::int64_t bytes() const { return bytes_; }

 private:
  RecordingRing(std::string folder, std::int64_t max_bytes, OwnedFd lock);

  Status List();
  Status ListAgainIfDeleted();
  Status MakeRoom(std::int64_t bytes);
  Status CheckFreeSpace(std::int64_t bytes) const;
  // A new file, where the present one has no room for so much.
  Status Turn(std::int64_t bytes);
  Status StartFile();
  // At the end of the present file; of what fails nothing stays.
  Status Write(std::string_view bytes);
  Status Failed(const char* what, int error) const;
  std::string PathOf(std::int64_t number) const;

  std::string folder_;
  std::int64_t max_bytes_;
  OwnedFd lock_;  // of the folder
  OwnedFd file_;  // none: the next record starts one
  std::int64_t file_bytes_ = 0;
  std::int64_t bytes_ = 0;
  std::int64_t next_ = 1;
  std::map<std::int64_t, std::int64_t> files_;  // number: bytes; the present one is the last
};

}  // namespace maploc
