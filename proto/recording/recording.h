// A recording: one file, or the folder of a server's --recorder, whose files follow each other in
// time. A server may go on writing meanwhile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "proto/recording/recorded_query.h"

namespace maploc {

// A recording's file in a folder is named so, with its number: "queries-0000000001.recording".
std::string RecordingName(std::int64_t number);
// None where the name is not of that form.
std::optional<std::int64_t> RecordingNumber(const std::string& name);

// Empty: any.
struct RecordingFilter {
  std::string map = {};
  std::string robot = {};
  std::string outcome = {};  // OutcomeText

  bool Matches(const RecordedQuery& query) const;
};

struct RecordPosition {
  std::size_t file = 0;
  std::int64_t offset = 0;
};

class Recording {
 public:
  // NOT_FOUND: there is nothing at the path, or no recording in the folder.
  static Result<Recording> Open(const std::string& path);

  // The last `most` that match, the oldest first. NOT_FOUND (NOTHING_RECORDED) where there is none;
  // an error of any file is that of the whole. REQUIRES: most > 0.
  Result<std::vector<RecordPosition>> FindLast(const RecordingFilter& filter,
                                               std::size_t most) const;
  // REQUIRES: a position that FindLast gave. NOT_FOUND where the server has overwritten it since.
  Result<RecordedQuery> Read(const RecordPosition& position) const;

 private:
  explicit Recording(std::vector<std::string> files) : files_(std::move(files)) {}

  std::vector<std::string> files_;
};

}  // namespace maploc
