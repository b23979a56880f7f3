// Internal to server/sessions.
#pragma once

#include <chrono>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/sessions/session_manager.h"

namespace maploc {

// Guarded by SessionManager::mutex_, `session` apart, which never changes.
struct SessionManager::Open {
  Open(Session opened, std::int64_t first_sequence, std::chrono::steady_clock::time_point now)
      : session(std::move(opened)), next_sequence(first_sequence), last_activity(now) {}

  const Session session;
  std::int64_t next_sequence;
  std::vector<Observation> unsaved;  // ascending by sequence
  int running = 0;                   // leases
  bool ending = false;               // no more leases
  bool gone = false;                 // ended; nothing is recorded any more
  std::chrono::steady_clock::time_point last_activity;
};

}  // namespace maploc
