#include "server/recorder/recording_ring.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include "proto/recording/crc_frame.h"
#include "proto/recording/recording.h"

namespace maploc {
namespace {

constexpr std::int64_t kFiles = 16;

// Names in a row that somebody else has taken.
constexpr int kMostTaken = 1000;

Status Unusable(const std::string& folder, const std::string& what) {
  return Status(StatusCode::kFailedPrecondition, "RECORDER_UNUSABLE",
                "--recorder: " + folder + ": " + what);
}

Result<OwnedFd> Lock(const std::string& folder) {
  OwnedFd lock(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!lock) return Unusable(folder, std::strerror(errno));
  if (flock(lock.get(), LOCK_EX | LOCK_NB) == 0) return lock;
  return Status(StatusCode::kUnavailable, "RECORDER_IN_USE",
                "--recorder: " + folder + ": another server records there; name another folder");
}

}  // namespace

Status CheckRecorderFolder(const std::string& folder) {
  std::error_code none;
  const std::filesystem::path path(folder);
  if (std::filesystem::is_directory(path, none)) {
    if (access(folder.c_str(), R_OK | W_OK | X_OK) == 0) return Status::Ok();
    return Unusable(folder, "may not be written to; check its permissions");
  }
  if (std::filesystem::exists(path, none)) return Unusable(folder, "is no folder");
  const std::filesystem::path above = std::filesystem::absolute(path, none).parent_path();
  if (std::filesystem::is_directory(above, none)) return Status::Ok();
  return Unusable(folder, "the folder " + above.string() + " does not exist; make it");
}

RecordingRing::RecordingRing(std::string folder, std::int64_t max_bytes, OwnedFd lock)
    : folder_(std::move(folder)), max_bytes_(max_bytes), lock_(std::move(lock)) {}

Result<RecordingRing> RecordingRing::Open(const std::string& folder, std::int64_t max_bytes) {
  MAPLOC_RETURN_IF_ERROR(CheckRecorderFolder(folder));
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    return Unusable(folder, std::string("cannot be made: ") + std::strerror(errno));
  }
  MAPLOC_ASSIGN_OR_RETURN(OwnedFd lock, Lock(folder));
  RecordingRing ring(folder, max_bytes, std::move(lock));
  MAPLOC_RETURN_IF_ERROR(ring.List());
  MAPLOC_RETURN_IF_ERROR(ring.MakeRoom(0));
  return ring;
}

Status RecordingRing::List() {
  std::error_code error;
  files_.clear();
  bytes_ = 0;
  for (std::filesystem::directory_iterator entry(folder_, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto number = RecordingNumber(entry->path().filename().string());
    // A link that leads nowhere is no error.
    std::error_code none;
    if (!number || !entry->is_regular_file(none)) continue;
    const auto size = static_cast<std::int64_t>(entry->file_size(error));
    files_[*number] = size;
    bytes_ += size;
  }
  if (error) return Unusable(folder_, "cannot be read: " + error.message());
  if (!files_.empty()) next_ = std::max(next_, files_.rbegin()->first + 1);
  return Status::Ok();
}

std::string RecordingRing::PathOf(std::int64_t number) const {
  return folder_ + "/" + RecordingName(number);
}

Status RecordingRing::Failed(const char* what, int error) const {
  const std::string message = folder_ + ": " + what + ": " + std::strerror(error);
  if (error == ENOSPC || error == EDQUOT || error == EFBIG) {
    return ResourceExhausted("DISK_FULL", message);
  }
  return Status(StatusCode::kUnavailable, "RECORDER_IO", message);
}

// The present file goes too where nothing else is left: then its records are the oldest.
Status RecordingRing::MakeRoom(std::int64_t bytes) {
  while (bytes_ + bytes > max_bytes_ && !files_.empty()) {
    const auto [number, size] = *files_.begin();
    if (files_.size() == 1) file_ = OwnedFd();
    if (unlink(PathOf(number).c_str()) != 0 && errno != ENOENT) {
      return Failed("an old file cannot be deleted", errno);
    }
    bytes_ -= size;
    files_.erase(files_.begin());
  }
  return Status::Ok();
}

Status RecordingRing::CheckFreeSpace(std::int64_t bytes) const {
  struct statvfs disk {};
  if (fstatvfs(lock_.get(), &disk) != 0) return Failed("the disk cannot be asked", errno);
  const double free = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  if (free >= static_cast<double>(kFreeForOthers + bytes)) return Status::Ok();
  return ResourceExhausted("DISK_FULL", folder_ +
                                            ": less than 256 MiB of the disk are free, which "
                                            "are kept for others; make room");
}

Status RecordingRing::StartFile() {
  std::string path = PathOf(next_);
  const auto make = [&path] {
    // A new one: nothing that somebody has put there is followed or overwritten.
    return OwnedFd(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
  };
  OwnedFd file = make();
  for (int taken = 0; !file && errno == EEXIST && taken < kMostTaken; ++taken) {
    path = PathOf(++next_);
    file = make();
  }
  if (!file) return Failed(("a file cannot be made: " + path).c_str(), errno);
  const std::int64_t number = next_++;
  files_[number] = 0;
  file_ = std::move(file);
  file_bytes_ = 0;
  Status status = Write(kRecordingMagic);
  if (status.ok()) return status;
  file_ = OwnedFd();
  files_.erase(number);
  unlink(path.c_str());
  return status;
}

// An operator may delete what was recorded at any time, or cut it, as rotations of logs do.
Status RecordingRing::ListAgainIfDeleted() {
  struct stat file {};
  const bool is_there = file_ && fstat(file_.get(), &file) == 0 && file.st_nlink > 0;
  if (!file_ || (is_there && file.st_size == file_bytes_)) return Status::Ok();
  file_ = OwnedFd();
  return List();
}

Status RecordingRing::Turn(std::int64_t bytes) {
  const auto begin = static_cast<std::int64_t>(kRecordingMagic.size());
  const bool is_full = file_bytes_ > begin && file_bytes_ + bytes > max_bytes_ / kFiles;
  if (file_ && !is_full) return MakeRoom(bytes);
  MAPLOC_RETURN_IF_ERROR(MakeRoom(bytes + begin));
  return StartFile();
}

Status RecordingRing::Write(std::string_view bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const auto at = static_cast<off_t>(file_bytes_ + static_cast<std::int64_t>(written));
    const ssize_t more = pwrite(file_.get(), bytes.data() + written, bytes.size() - written, at);
    if (more < 0 && errno == EINTR) continue;
    if (more < 0) {
      const Status status = Failed("a record cannot be written", errno);
      // Where even that fails the next record starts a new file.
      if (ftruncate(file_.get(), static_cast<off_t>(file_bytes_)) != 0) file_ = OwnedFd();
      return status;
    }
    written += static_cast<std::size_t>(more);
  }
  const auto size = static_cast<std::int64_t>(bytes.size());
  file_bytes_ += size;
  files_.rbegin()->second += size;
  bytes_ += size;
  return Status::Ok();
}

Status RecordingRing::Append(std::string_view record) {
  if (record.empty() || record.size() > kMaxRecordBytes) {
    return Status(StatusCode::kResourceExhausted, "RECORD_TOO_LARGE",
                  "a record of " + std::to_string(record.size()) + " bytes is not written");
  }
  const auto frame = FrameToBytes(FrameOf(record));
  std::string bytes(frame.begin(), frame.end());
  bytes.append(record);
  const auto size = static_cast<std::int64_t>(bytes.size());
  MAPLOC_RETURN_IF_ERROR(ListAgainIfDeleted());
  MAPLOC_RETURN_IF_ERROR(CheckFreeSpace(size));
  MAPLOC_RETURN_IF_ERROR(Turn(size));
  return Write(bytes);
}

}  // namespace maploc
