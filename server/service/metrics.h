// What an operator watches, in Prometheus' text format: calls, answers, times, and the state of the
// process. Counters begin with the process. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"
#include "server/recorder/query_recorder.h"
#include "server/sessions/segment_cache.h"

namespace maploc {

// The label of maps and reasons beyond the first so many: the number of time series stays bounded.
inline constexpr char kOther[] = "(other)";
inline constexpr std::size_t kMaxMapLabels = 200;
inline constexpr std::size_t kMaxReasonLabels = 100;

// Read when somebody scrapes.
struct ServerState {
  bool healthy = true;
  std::size_t open_sessions = 0;
  std::size_t unsaved_observations = 0;  // answered, not yet in the store
  double store_lag_s = 0.0;              // the age of the oldest of them
  std::size_t lost_observations = 0;     // since the start; answered, and never in the store
  std::size_t localizations = 0;         // that run or wait
  std::size_t localizations_limit = 0;   // beyond it they are refused
  SegmentCacheState cache;
  std::size_t lost_log_lines = 0;                      // since the start
  RecorderState recorder;                              // zeros: nothing is recorded
  std::optional<std::int64_t> certificate_end_unix_s;  // none: no TLS
};

class ServerMetrics {
 public:
  ServerMetrics();
  ~ServerMetrics();
  ServerMetrics(const ServerMetrics&) = delete;
  ServerMetrics& operator=(const ServerMetrics&) = delete;

  // A call that was answered or refused. `method`: "Localize".
  void CountCall(const std::string& method, const Status& status, double seconds);
  // How long an admitted call waited for a thread.
  void ObserveWait(const std::string& method, double seconds);
  // A query that was worked on, whatever became of it.
  void CountAnswer(const Localization& answer);

  std::string Text(const ServerState& state);

 private:
  struct Impl;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace maploc
