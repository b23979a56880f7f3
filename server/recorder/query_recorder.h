// The server's flight recorder: queries as robots sent them and what became of them, on disk, for
// `maploc replay --recorded` and `maploc-map compare`. Recorded are all that were refused or
// localized with a doubt, and of the others every Nth; never an image or a token, because neither
// is part of a request.
//
// Nobody waits for it: a thread of its own writes, and what comes faster than the disk takes it, or
// while the disk is full, is lost and counted.
//
// Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "mapstore/base/status.h"

namespace maploc::recording::v1 {
class RecordedQuery;
}  // namespace maploc::recording::v1

namespace maploc {

struct RecorderOptions {
  std::string folder;                              // empty: nothing is recorded
  std::int64_t max_bytes = std::int64_t{1} << 30;  // on disk; the oldest go
  int every = 10;                                  // of those that are localized without doubt
};

// What an operator watches.
struct RecorderState {
  std::int64_t bytes = 0;    // on disk
  std::size_t recorded = 0;  // since the start
  std::size_t lost = 0;      // since the start: were to be recorded
};

class QueryRecorder {
 public:
  // Errors name --recorder, cause and cure. REQUIRES: max_bytes >= kMinRecorderBytes, every > 0.
  static Result<std::unique_ptr<QueryRecorder>> Start(const RecorderOptions& options);
  // Writes what waits, for a second at most.
  ~QueryRecorder();
  QueryRecorder(const QueryRecorder&) = delete;
  QueryRecorder& operator=(const QueryRecorder&) = delete;

  // Takes a finished query, if it is to be recorded; sets its stands_for_count. Does not wait.
  void Offer(recording::v1::RecordedQuery&& query);

  RecorderState state() const;

 private:
  struct Impl;
  explicit QueryRecorder(std::unique_ptr<Impl> impl);
  const std::unique_ptr<Impl> impl_;
};

}  // namespace maploc
