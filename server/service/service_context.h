// What handlers work with: the domain behind its interfaces, and what is known of one call.
#pragma once

#include <atomic>
#include <chrono>
#include <string>

#include "mapstore/base/clock.h"
#include "mapstore/store/map_store.h"
#include "server/access/caller.h"
#include "server/access/token_book.h"
#include "server/pipeline/localizer.h"
#include "server/recorder/query_recorder.h"
#include "server/service/metrics.h"
#include "server/service/request_log.h"
#include "server/sessions/answered_queries.h"
#include "server/sessions/map_cache.h"
#include "server/sessions/session_manager.h"

namespace maploc {

// All outlive the service and are thread-safe.
struct ServiceContext {
  MapStore* store = nullptr;
  SessionManager* sessions = nullptr;
  AnsweredQueries* answered = nullptr;
  MapCache* maps = nullptr;
  ServerMetrics* metrics = nullptr;
  RequestLog* requests = nullptr;
  QueryRecorder* recorder = nullptr;  // null: nothing is recorded
  TokenBook* tokens = nullptr;
  const Clock* clock = &SystemClock();
  LocalizerOptions localizer;
  std::string store_path;  // what robots are not told
};

// One running call.
struct Call {
  Deadline deadline = kNoDeadline;
  const std::atomic<bool>* cancelled = nullptr;  // set when the client has gone; may be null
  Caller caller;                                 // what it may do, each handler asks
  RequestFacts* facts = nullptr;  // the handler tells them as soon as it knows them; never null
};

}  // namespace maploc
