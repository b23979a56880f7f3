// Reading one file of a recording, record by record. What it cannot be trusted in is refused with
// the file and the byte at which it went wrong; an end that a killed server has torn is no fault.
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#include "mapstore/base/status.h"
#include "proto/recording/crc_frame.h"
#include "proto/recording/recorded_query.h"

namespace maploc {

// Not thread-safe.
class RecordingFile {
 public:
  // NOT_FOUND (FILE_NOT_FOUND); INVALID_ARGUMENT where the file is none, or of a newer format.
  static Result<RecordingFile> Open(const std::string& path);

  // The next record; none at the end. DATA_LOSS (DAMAGED_RECORDING) names file and byte.
  Result<std::optional<RecordedQuery>> Next();
  // Where the next record begins.
  std::int64_t offset() const { return offset_; }
  // Go on at an offset() of before.
  void Seek(std::int64_t offset) { offset_ = offset; }

 private:
  RecordingFile(std::string path, std::ifstream file, std::int64_t size);
  // None: the file ends within the frame.
  std::optional<Frame> ReadFrame();
  // From here to the end.
  bool HasZerosAlone();
  Status Damaged(const std::string& what) const;

  std::string path_;
  std::ifstream file_;
  std::int64_t size_ = 0;
  std::int64_t offset_ = 0;
};

}  // namespace maploc
