// Many robots at once against a server, each asking the same recorded queries over and over: what
// the server bears, and how long a robot waits.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "client/api/client.h"
#include "mapstore/model/query.h"

namespace maploc {

struct LoadOptions {
  int robots = 16;
  std::chrono::duration<double> duration{10.0};
  // Queries a second of all robots together, evenly spaced and each at its own moment whether or
  // not the server keeps up; a latency counts from that moment. Zero: each robot asks again as soon
  // as it is answered.
  double rate_per_second = 0.0;
  bool sessions = true;         // else queries outside of any session, which are not counted
  int queries_a_session = 100;  // then it is ended, and a new one is started
  ClientOptions client;         // of each robot's connection; queries are never sent again
  // Asked before each query; true ends the run early, every session too. May be empty.
  std::function<bool()> stop;
};

struct LoadReport {
  std::int64_t requests = 0;
  std::chrono::duration<double> elapsed{0.0};
  std::vector<double> latencies_ms;  // of answered queries
  std::map<Outcome, std::int64_t> outcomes;
  std::int64_t gravity_rejected = 0;           // of those localized
  std::map<std::string, std::int64_t> errors;  // of queries, by the code's name
  std::vector<double> end_session_ms;          // of answered EndSessions
};

// `server` is HOST:PORT; each robot has a connection of its own, and its queries are sent once (a
// refusal is an error that counts). The first Status of a session that cannot be started or ended
// ends the run (with the id of one that may be open still). RESOURCE_EXHAUSTED (TOO_MANY_THREADS):
// nothing was sent, for each robot takes a thread. REQUIRES: queries is not empty; robots
// and queries_a_session >= 1; duration and rate finite and >= 0, duration within what a clock
// counts (292 years).
Result<LoadReport> RunLoad(const std::string& server, const std::string& map,
                           const std::vector<Query>& queries, const LoadOptions& options);

}  // namespace maploc
