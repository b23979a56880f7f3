// One line a request, so that an operator can tell what became of a robot's query. Refused and slow
// requests have a line each, of the others every Nth. Refusals that repeat one of the last seconds
// (the same method and reason) are counted, and the count is a line.
//
// Lines are written by a thread of the log's own: nobody waits for the disk. Where lines come
// faster than they can be written the oldest are lost, and counted.
//
// Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "mapstore/base/clock.h"
#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"

namespace spdlog::sinks {
class sink;
}

namespace maploc {

struct RequestLogOptions {
  bool json = false;        // else text: key=value, the values as in JSON
  int every = 100;          // of the requests that are neither refused nor slow; 0: none
  double slow_ms = 1000.0;  // from here on a request is slow; 0: none is
};

// What a call's handler learns about it. Names are checked (mapstore/base/name.h) before they get
// here.
struct RequestFacts {
  std::string request_id;
  std::string robot;
  std::string map;
  std::int64_t version = 0;  // 0: not known
  std::string session;
  std::optional<Outcome> outcome;
  StageTimes times;        // where there is an outcome
  bool is_repeat = false;  // it got the answer that it had got before
};

// A call that is over.
struct FinishedRequest {
  std::string method;  // "Localize"
  const Status& status;
  std::string traceparent;  // ParseTraceparent's
  const RequestFacts& facts;
  double wait_ms = 0.0;   // in the queue
  double total_ms = 0.0;  // from its arrival to its answer
};

class RequestLog {
 public:
  // Writes from the level on that spdlog has at this moment: info; slow and refused requests are
  // warnings, the server's own accidents errors.
  RequestLog(const RequestLogOptions& options, std::shared_ptr<spdlog::sinks::sink> sink,
             const Clock& clock = SystemClock());
  // Writes what waits, and the counts.
  ~RequestLog();
  RequestLog(const RequestLog&) = delete;
  RequestLog& operator=(const RequestLog&) = delete;

  void Write(const FinishedRequest& request);
  // Lines that were not written because the reader or the disk was too slow.
  std::size_t lost_lines() const;

 private:
  struct Impl;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace maploc
