// The life of sessions: started, fed with one observation a query, ended once. Knows the store's
// interface alone.
//
// A query never waits for the disk: observations are kept in memory and written in groups, at most
// `flush_interval` later, by a thread of this class. EndSession waits for the session's running
// queries, so that a query that was answered is always counted. What the store has refused for now
// stays in memory and is written again.
//
// Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "mapstore/base/clock.h"
#include "mapstore/base/status.h"
#include "mapstore/model/session.h"
#include "mapstore/store/map_store.h"
#include "server/sessions/health.h"

namespace maploc {

struct SessionManagerOptions {
  // How long an answered query may be lost by a crash (a clean stop loses none).
  std::chrono::milliseconds flush_interval{100};
  // A session without queries for this long is ended as kIdle; zero: never.
  std::chrono::milliseconds idle_timeout{std::chrono::minutes(30)};
  // When as many are open, the oldest one without a query ends for a new one.
  std::size_t max_open_sessions = 10000;
  std::size_t max_open_sessions_of_robot = 100;  // one works in one; the rest are forgotten ones
  // Queries are refused (UNAVAILABLE) while this many observations wait for a store that fails.
  std::size_t max_unsaved_observations = 100000;
  Health* health = nullptr;  // outlives the manager; null: nobody asks, failures are logged alone
};

// What a robot asks for.
struct NewSession {
  MapKey map;
  std::string robot;
  std::map<std::string, std::string> labels;
  std::string request_id;             // may be empty: then every start is a new session
  std::int64_t required_version = 0;  // of the map; 0: any
};

// Labels under this prefix are the server's own; the request's id stands there so that a repeated
// start is known after a restart of the server.
inline constexpr char kReservedLabelPrefix[] = "maploc.";
inline constexpr char kRequestIdLabel[] = "maploc.request_id";

class SessionManager {
  struct Open;

 public:
  // One running query of an open session: while it lives the session cannot end. Move-only.
  class Lease {
   public:
    Lease(Lease&& other) noexcept
        : manager_(std::exchange(other.manager_, nullptr)), open_(std::move(other.open_)) {}
    Lease& operator=(Lease&&) = delete;
    ~Lease();

    const Session& session() const;
    // The query's observation; its sequence is given here. One that is counted_as another
    // counts nothing. INTERNAL for one that no store takes (a number that is not finite): it would
    // keep its whole session from being written and ended.
    // REQUIRES: called at most once.
    Status Record(Observation observation);

   private:
    friend class SessionManager;
    Lease(SessionManager* manager, std::shared_ptr<Open> open);

    SessionManager* manager_;  // null once moved from
    std::shared_ptr<Open> open_;
  };

  // Takes up the sessions that the store holds open. `store` and `clock` must outlive the manager.
  static Result<std::unique_ptr<SessionManager>> Create(MapStore* store,
                                                        const SessionManagerOptions& options = {},
                                                        const Clock& clock = SystemClock());
  // Stops without a last flush; call Shutdown before.
  ~SessionManager();
  SessionManager(const SessionManager&) = delete;
  SessionManager& operator=(const SessionManager&) = delete;

  // Repeated with the same robot and request_id within a day it gives the same session. Errors:
  // FAILED_PRECONDITION (REQUEST_ID_REUSED) for another map's name or when that session has ended,
  // (MAP_VERSION_MISMATCH) where the session is or would be on another version than the required;
  // INVALID_ARGUMENT (RESERVED_LABEL); RESOURCE_EXHAUSTED (TOO_MANY_SESSIONS); the store's, also
  // STORE_BUSY where other starts last longer than the thread's WaitLimit.
  Result<Session> Start(const NewSession& request);

  // Lets a query in. Errors: NOT_FOUND (SESSION_NOT_FOUND); FAILED_PRECONDITION (SESSION_CLOSED);
  // UNAVAILABLE (STATISTICS_BACKLOG).
  Result<Lease> Enter(const SessionId& id);

  // Waits for the session's running queries, then ends it in one transaction. Repeated, also after
  // a restart: the kept summary. Errors: NOT_FOUND (SESSION_NOT_FOUND); DEADLINE_EXCEEDED: nothing
  // has changed, the session goes on; the store's.
  Result<SessionSummary> End(const SessionId& id, Deadline deadline = kNoDeadline);

  // Writes what waits. Called by the thread; public for a clean stop and for tests.
  Status Flush();
  // Ends sessions that have been idle too long; those that cannot be ended now are tried again.
  Status CloseIdle();
  // No more queries are let in, what waits is written; sessions stay open in the store. Idempotent.
  Status Shutdown();

  std::size_t open_sessions() const;
  // Observations that are not in the store yet.
  std::size_t unsaved_observations() const;
  // The age of the oldest of them; 0: there is none.
  double unsaved_age_s() const;
  // Observations that came too late, because another process had ended their session.
  std::size_t lost_observations() const { return lost_; }

 private:
  using RequestKey = std::pair<std::string, std::string>;  // robot, request_id
  struct Remembered {
    SessionId session;
    std::string map_name;
    std::int64_t start_unix_ns = 0;
  };

  // What one session has to write.
  struct Batch {
    std::shared_ptr<Open> open;
    std::vector<Observation> observations;
  };

  SessionManager(MapStore* store, const SessionManagerOptions& options, const Clock& clock);
  Status Recover();
  void Run();
  void StopThread();
  void Remember(const Session& session);
  void ForgetOldRequests();
  Result<std::optional<Session>> FindRepeated(const NewSession& request) const;
  Status MakeRoom(const std::string& robot);
  // The one that has waited longest for its first query; null: each had one.
  std::shared_ptr<Open> ClaimUnused();
  Result<Session> StartNew(const NewSession& request);
  Status ClosedOrUnknown(const SessionId& id) const;
  bool Wait(std::unique_lock<std::mutex>& lock, Deadline deadline,
            const std::function<bool()>& condition);
  // Closes the session to queries and waits for those that run. Null: it is not open here.
  Result<std::shared_ptr<Open>> Claim(const SessionId& id, Deadline deadline);
  Result<SessionSummary> EndInStore(const SessionId& id) const;
  // REQUIRES: `open->ending` was set by the caller and nothing runs.
  Result<SessionSummary> Finish(const std::shared_ptr<Open>& open, SessionEnd end);
  // Everything that is not on disk, in groups of one transaction each.
  std::vector<std::vector<Batch>> Waiting() const;
  Status WriteRound();
  // A failure while many observations wait is STATISTICS_BACKLOG.
  Status WithBacklog(const Status& status) const;
  void NoteRefusal(const Status& status);
  Status FlushGroup(const std::vector<Batch>& group);
  Status FlushOneByOne(const std::vector<Batch>& group, const Status& refused);
  void DropEnded(const Batch& batch);
  // REQUIRES: mutex_ is held.
  void Drop(const std::shared_ptr<Open>& open);
  void EraseSaved(const std::shared_ptr<Open>& open, std::int64_t last_sequence);

  MapStore* const store_;
  const SessionManagerOptions options_;
  const Clock& clock_;
  Health own_health_;

  std::timed_mutex start_mutex_;  // one start at a time, so that a repeated one finds the first
  std::map<RequestKey, Remembered> remembered_;  // guarded by start_mutex_
  std::mutex flush_mutex_;                       // one flush at a time
  std::atomic<std::size_t> lost_ = 0;
  std::atomic<bool> refused_ = false;  // a start or an end, by a store that may refuse all

  mutable std::mutex mutex_;  // guards all below; never held over a call of the store
  std::condition_variable changed_;
  std::map<SessionId, std::shared_ptr<Open>> open_;
  std::size_t unsaved_ = 0;             // observations in all sessions
  std::atomic<bool> stopping_ = false;  // changed under mutex_; the thread's waits look at it, too
  std::once_flag joined_;
  std::thread thread_;
};

}  // namespace maploc
