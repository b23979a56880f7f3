// What an operator watches, in Prometheus' text format: calls, answers, times, and the state of the
// process. Counters begin with the process. Thread-safe.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"

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
  std::size_t localizations = 0;         // that run or wait
};

class ServerMetrics {
 public:
  ServerMetrics();
  ~ServerMetrics();
  ServerMetrics(const ServerMetrics&) = delete;
  ServerMetrics& operator=(const ServerMetrics&) = delete;

  // A call that was answered or refused. `method`: "Localize".
  void CountCall(const std::string& method, const Status& status, double seconds);
  // A query that was worked on, whatever became of it.
  void CountAnswer(const Localization& answer);

  std::string Text(const ServerState& state);

 private:
  struct Impl;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace maploc
