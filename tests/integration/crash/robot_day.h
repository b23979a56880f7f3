// One robot that works until its server dies, and what it knows of its sessions.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/api/client.h"
#include "mapstore/base/random.h"
#include "mapstore/model/query.h"
#include "mapstore/model/session.h"

namespace maploc::testing {

// A session that has not been seen to end.
struct RunningSession {
  SessionId id;
  int planned = 0;           // queries, before it is ended
  std::int64_t settled = 0;  // observations that were found on disk after the last kill
  // Since then: the moments at which answers arrived, and queries without one.
  std::vector<std::chrono::steady_clock::time_point> answered;
  int unanswered = 0;
  bool end_was_asked = false;

  std::int64_t Known() const { return settled + static_cast<std::int64_t>(answered.size()); }
};

class RobotDay {
 public:
  // `queries` outlive the robot.
  RobotDay(std::string name, const std::vector<Query>& queries, Random random)
      : name_(std::move(name)), queries_(queries), random_(random) {}

  // Sessions of queries, one after the other, until a call finds no server.
  void WorkUntilTheServerDies(const std::string& address);

  // Of the session that the server's death interrupted; nullopt between two sessions.
  std::optional<RunningSession>& running() { return running_; }
  // What each answered EndSession said.
  const std::map<SessionId, SessionSummary>& ended() const { return ended_; }

 private:
  // False when there is no server any more. Any other failure is the test's.
  static bool Served(const Status& status, const char* call);
  bool Begin(const Client& client);
  bool Ask(const Client& client);
  bool End(const Client& client);

  const std::string name_;
  const std::vector<Query>& queries_;
  Random random_;
  std::optional<RunningSession> running_;
  std::map<SessionId, SessionSummary> ended_;
};

}  // namespace maploc::testing
