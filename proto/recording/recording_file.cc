#include "proto/recording/recording_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "mapstore/base/path_kind.h"

namespace maploc {
namespace {

Status CheckMagic(const std::string& path, const std::string& begin) {
  if (begin == kRecordingMagic) return Status::Ok();
  const std::string_view name = kRecordingMagic.substr(0, kRecordingMagic.size() - 1);
  if (begin.size() == kRecordingMagic.size() && begin.starts_with(name)) {
    return InvalidArgument(path, "byte 7: is a recording of another format; use a newer maploc",
                           "RECORDING_TOO_NEW");
  }
  return InvalidArgument(path, "byte 0: is no recording of maploc-server --recorder",
                         "NOT_A_RECORDING");
}

}  // namespace

RecordingFile::RecordingFile(std::string path, std::ifstream file, std::int64_t size)
    : path_(std::move(path)),
      file_(std::move(file)),
      size_(size),
      offset_(static_cast<std::int64_t>(kRecordingMagic.size())) {}

Result<RecordingFile> RecordingFile::Open(const std::string& path) {
  if (!Exists(path)) {
    return Status(StatusCode::kNotFound, "FILE_NOT_FOUND", path + ": there is no such file");
  }
  // Anything else might be read for ever.
  if (!IsRegularFile(path)) {
    return InvalidArgument(path, "is no regular file", "NOT_A_RECORDING");
  }
  std::ifstream file(path, std::ios::binary);
  std::string begin(kRecordingMagic.size(), '\0');
  if (!file) return InvalidArgument(path, "cannot be read; check its permissions", "NOT_READABLE");
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  // A server was killed before it had written more.
  if (!kRecordingMagic.starts_with(begin)) MAPLOC_RETURN_IF_ERROR(CheckMagic(path, begin));
  std::error_code none;
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path, none));
  return RecordingFile(path, std::move(file), none ? 0 : size);
}

std::optional<Frame> RecordingFile::ReadFrame() {
  std::array<char, kFrameBytes> bytes{};
  file_.clear();
  file_.seekg(offset_);
  file_.read(bytes.data(), bytes.size());
  if (!file_) return std::nullopt;
  return FrameFromBytes(bytes);
}

// A file system that lost its power may have kept a file's new length and not its end.
bool RecordingFile::HasZerosAlone() {
  std::array<char, 4096> bytes{};
  file_.clear();
  file_.seekg(offset_);
  while (file_) {
    file_.read(bytes.data(), bytes.size());
    const auto end = bytes.begin() + file_.gcount();
    if (std::any_of(bytes.begin(), end, [](char byte) { return byte != 0; })) return false;
  }
  return true;
}

Status RecordingFile::Damaged(const std::string& what) const {
  return Status(StatusCode::kDataLoss, "DAMAGED_RECORDING",
                path_ + ": byte " + std::to_string(offset_) + ": " + what +
                    "; move this file away to use the others");
}

Result<std::optional<RecordedQuery>> RecordingFile::Next() {
  const std::optional<Frame> frame = ReadFrame();
  if (!frame) return std::optional<RecordedQuery>();
  if (frame->length == 0 && HasZerosAlone()) return std::optional<RecordedQuery>();
  if (frame->length == 0 || frame->length > kMaxRecordBytes) {
    return Damaged("a record of " + std::to_string(frame->length) + " bytes cannot be");
  }
  const std::int64_t end = offset_ + static_cast<std::int64_t>(kFrameBytes + frame->length);
  // Checked before memory is taken.
  if (end > size_) return std::optional<RecordedQuery>();
  std::string record(frame->length, '\0');
  file_.read(record.data(), static_cast<std::streamsize>(record.size()));
  if (!file_) return Damaged("the file cannot be read");
  if (FrameOf(record) != *frame) {
    if (end == size_) return std::optional<RecordedQuery>();
    return Damaged("the record's checksum does not fit its bytes");
  }
  Result<RecordedQuery> query = RecordedQueryFromBytes(record);
  if (!query.ok()) return Damaged(query.status().message());
  offset_ = end;
  return std::optional<RecordedQuery>(*std::move(query));
}

}  // namespace maploc
