// maploc's C++ client: one connection to one server. A call has a deadline, and is repeated until
// then, where that is safe, as every call of this client is: after UNAVAILABLE (StartSession and
// Localize within a session by their request_id), and where the server asks for it (a full
// queue). A name that is not UTF-8 or too long (mapstore/base/name.h)
// is refused before any call. A server on this machine is reached without the environment's proxy.
// gRPC's headers stay in client.cc.
//
// Thread-safe.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"
#include "mapstore/model/map.h"
#include "mapstore/model/query.h"
#include "mapstore/model/session.h"

namespace maploc {

// How a client trusts the server, and shows who it is itself. Texts, not files: ReadCredentials
// (credentials.h) reads them.
struct ClientCredentials {
  std::string ca_pem;    // authorities of the server's certificate; empty: plain text
  std::string cert_pem;  // the client's own certificate and key, where the server asks for one
  std::string key_pem;
  std::string token;  // sent with each call; empty: none
};

struct ClientOptions {
  std::chrono::milliseconds call_timeout{10000};  // of a call with its repetitions
  int max_attempts = 4;                           // of a call
  ClientCredentials credentials;
};

// What GetMap tells of a map.
struct RemoteMap {
  MapInfo info;
  int segments = 0;
  std::int64_t points = 0;
  std::int64_t lines = 0;
  std::int64_t usable_lines = 0;
};

// What ListSegments tells of a segment.
struct RemoteSegment {
  SegmentId id = 0;
  int points = 0;
  int lines = 0;
  int usable_lines = 0;
  StrategyDecision decision;  // strategy and source alone
  std::optional<double> point_inlier_ratio;
  std::optional<double> line_inlier_ratio;
  std::int64_t sessions = 0;
  std::int64_t queries = 0;
  std::int64_t localized = 0;
  std::vector<Eigen::Vector3d> path_in_map;  // from GetSegment alone
};

class Client {
 public:
  // Does not connect yet: the first call does. `server` is HOST:PORT. With a token and without TLS
  // it must be this machine: to any other every call is FAILED_PRECONDITION (TOKEN_IN_CLEAR).
  explicit Client(const std::string& server, const ClientOptions& options = {});
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  // As it was given.
  const std::string& server() const;

  Result<std::vector<RemoteMap>> ListMaps() const;
  Result<RemoteMap> GetMap(const std::string& map) const;
  Result<std::vector<RemoteSegment>> ListSegments(const std::string& map) const;
  Result<RemoteSegment> GetSegment(const std::string& map, SegmentId id) const;

  // `map_version` not 0: FAILED_PRECONDITION (MAP_VERSION_MISMATCH) where robots get another one.
  Result<SessionId> StartSession(const std::string& map, const std::string& robot,
                                 const std::map<std::string, std::string>& labels,
                                 std::int64_t map_version = 0) const;
  // With `include_matches` the answer holds matches and inliers. Within a session a query counts
  // once, however often it is sent under its request_id; one without gets an id for this call.
  Result<Localization> Localize(const Query& query, bool include_matches = false) const;
  Result<SessionSummary> EndSession(const SessionId& session) const;
  // Ends it so that none of its queries counts in the statistics.
  Result<SessionSummary> DiscardSession(const SessionId& session) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace maploc
