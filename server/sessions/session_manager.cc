// Start, recovery and the queries of a session; session_writer.cc has what goes to the store later.
#include "server/sessions/session_manager.h"

#include <algorithm>

#include "mapstore/base/name.h"
#include "mapstore/base/wait_limit.h"
#include "mapstore/store/validation.h"
#include "server/sessions/map_version.h"
#include "server/sessions/open_session.h"
#include "server/sessions/session_id.h"

namespace maploc {
namespace {

constexpr std::int64_t kRememberNs = 24ll * 3600 * 1'000'000'000;

Status SessionNotFound(const SessionId& id) {
  return NotFound("session '" + id + "'", "SESSION_NOT_FOUND");
}

std::int64_t LastSequence(const std::vector<Observation>& observations) {
  std::int64_t last = 0;
  for (const Observation& observation : observations) last = std::max(last, observation.sequence);
  return last;
}

Status CheckLabels(const std::map<std::string, std::string>& labels) {
  for (const auto& [name, value] : labels) {
    if (name.starts_with(kReservedLabelPrefix)) {
      return InvalidArgument(LabelField(name), "names under 'maploc.' are the server's own",
                             "RESERVED_LABEL");
    }
  }
  return Status::Ok();
}

}  // namespace

SessionManager::Lease::Lease(SessionManager* manager, std::shared_ptr<Open> open)
    : manager_(manager), open_(std::move(open)) {}

SessionManager::Lease::~Lease() {
  if (manager_ == nullptr) return;
  {
    const std::lock_guard lock(manager_->mutex_);
    --open_->running;
    open_->last_activity = manager_->clock_.SteadyNow();
  }
  manager_->changed_.notify_all();
}

const Session& SessionManager::Lease::session() const { return open_->session; }

Status SessionManager::Lease::Record(Observation observation) {
  const std::lock_guard lock(manager_->mutex_);
  if (open_->gone) return Status::Ok();  // another process ended the session
  observation.sequence = open_->next_sequence;
  if (const Status valid = ValidateObservation(observation); !valid.ok()) {
    return Internal("this query cannot be counted: " + valid.message());
  }
  ++open_->next_sequence;
  open_->unsaved.push_back(observation);
  ++manager_->unsaved_;
  return Status::Ok();
}

SessionManager::SessionManager(MapStore* store, const SessionManagerOptions& options,
                               const Clock& clock)
    : store_(store), options_(options), clock_(clock) {}

Result<std::unique_ptr<SessionManager>> SessionManager::Create(MapStore* store,
                                                               const SessionManagerOptions& options,
                                                               const Clock& clock) {
  std::unique_ptr<SessionManager> manager(new SessionManager(store, options, clock));
  MAPLOC_RETURN_IF_ERROR(manager->Recover().WithContext("taking up open sessions"));
  manager->thread_ = std::thread([raw = manager.get()] { raw->Run(); });
  return manager;
}

SessionManager::~SessionManager() { StopThread(); }

Status SessionManager::Recover() {
  if (store_->read_only()) return Status::Ok();  // there nothing can be added or ended
  MAPLOC_ASSIGN_OR_RETURN(const std::vector<Session> sessions, store_->ListSessions());
  for (const Session& session : sessions) {
    Remember(session);
    if (session.end != SessionEnd::kOpen) continue;
    MAPLOC_ASSIGN_OR_RETURN(const std::vector<Observation> observations,
                            store_->ListObservations(session.id));
    // Idle time counts from now: while the server was down the robot could not ask.
    open_.emplace(session.id, std::make_shared<Open>(session, LastSequence(observations) + 1,
                                                     clock_.SteadyNow()));
  }
  ForgetOldRequests();
  return Status::Ok();
}

void SessionManager::Remember(const Session& session) {
  const auto label = session.labels.find(kRequestIdLabel);
  if (label == session.labels.end()) return;
  remembered_[{session.robot, label->second}] = {session.id, session.map.name,
                                                 session.start_unix_ns};
}

void SessionManager::ForgetOldRequests() {
  const std::int64_t oldest = clock_.NowUnixNanos() - kRememberNs;
  std::erase_if(remembered_,
                [oldest](const auto& entry) { return entry.second.start_unix_ns < oldest; });
}

Result<std::optional<Session>> SessionManager::FindRepeated(const NewSession& request) const {
  if (request.request_id.empty()) return std::optional<Session>();
  const auto found = remembered_.find({request.robot, request.request_id});
  if (found == remembered_.end()) return std::optional<Session>();
  if (found->second.map_name != request.map.name) {
    return FailedPrecondition("REQUEST_ID_REUSED",
                              "request_id '" + request.request_id + "' started a session on map '" +
                                  found->second.map_name + "'; choose a new one");
  }
  MAPLOC_ASSIGN_OR_RETURN(Session session, store_->GetSession(found->second.session));
  if (session.end != SessionEnd::kOpen) {
    return FailedPrecondition("REQUEST_ID_REUSED", "request_id '" + request.request_id +
                                                       "' started session '" + session.id +
                                                       "', which has ended; choose a new one");
  }
  return std::optional<Session>(std::move(session));
}

Result<Session> SessionManager::Start(const NewSession& request) {
  MAPLOC_RETURN_IF_ERROR(CheckLabels(request.labels));
  const std::unique_lock start_lock(start_mutex_, WaitLimit::CurrentDeadline());
  if (!start_lock) {
    return Status(StatusCode::kUnavailable, "STORE_BUSY",
                  "other sessions wait to be started; try again");
  }
  ForgetOldRequests();
  // Before room is made: a repeated start needs none, and must not be refused by a full server.
  MAPLOC_ASSIGN_OR_RETURN(std::optional<Session> repeated, FindRepeated(request));
  const MapKey& map = repeated ? repeated->map : request.map;
  MAPLOC_RETURN_IF_ERROR(RequireMapVersion(map, request.required_version));
  if (repeated) return *std::move(repeated);
  MAPLOC_RETURN_IF_ERROR(MakeRoom(request.robot));
  return StartNew(request);
}

Status SessionManager::MakeRoom(const std::string& robot) {
  {
    const std::lock_guard lock(mutex_);
    const auto own = std::ranges::count_if(
        open_, [&robot](const auto& entry) { return entry.second->session.robot == robot; });
    if (static_cast<std::size_t>(own) >= options_.max_open_sessions_of_robot) {
      return ResourceExhausted(
          "TOO_MANY_SESSIONS",
          "robot '" + robot + "' has " + std::to_string(own) + " open sessions; end some");
    }
  }
  // start_mutex_ is held, so that none is added before this one.
  if (open_sessions() < options_.max_open_sessions) return Status::Ok();
  if (const std::shared_ptr<Open> unused = ClaimUnused()) {
    return Finish(unused, SessionEnd::kIdle).status();
  }
  return ResourceExhausted("TOO_MANY_SESSIONS", "too many sessions are open; end some");
}

std::shared_ptr<SessionManager::Open> SessionManager::ClaimUnused() {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<Open> oldest;
  for (const auto& [id, open] : open_) {
    // A sequence above 1: it had queries, also before a restart (Recover).
    if (open->next_sequence > 1 || open->running > 0 || open->ending) continue;
    if (oldest == nullptr || open->last_activity < oldest->last_activity) oldest = open;
  }
  if (oldest != nullptr) oldest->ending = true;
  return oldest;
}

Result<Session> SessionManager::StartNew(const NewSession& request) {
  Session session;
  MAPLOC_ASSIGN_OR_RETURN(session.id, NewSessionId());
  session.map = request.map;
  session.robot = request.robot;
  session.labels = request.labels;
  if (!request.request_id.empty()) session.labels[kRequestIdLabel] = request.request_id;
  session.start_unix_ns = clock_.NowUnixNanos();
  // In the store first: a robot must not be told an id that a crash forgets.
  if (const Status status = store_->StartSession(session); !status.ok()) {
    NoteRefusal(status);
    // The robot's words were checked; what is refused here is the server's own.
    const bool ours = status.code() == StatusCode::kInvalidArgument;
    return ours ? Internal("the session cannot be stored: " + status.message()) : status;
  }
  Remember(session);
  const std::lock_guard lock(mutex_);
  open_.emplace(session.id, std::make_shared<Open>(session, 1, clock_.SteadyNow()));
  return session;
}

Result<SessionManager::Lease> SessionManager::Enter(const SessionId& id) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) {
      return Status(StatusCode::kUnavailable, "SHUTTING_DOWN", "the server is stopping");
    }
    if (unsaved_ >= options_.max_unsaved_observations) {
      return Status(StatusCode::kUnavailable, "STATISTICS_BACKLOG",
                    "statistics cannot be written; see the server's log");
    }
    const auto found = open_.find(id);
    if (found != open_.end() && !found->second->ending) {
      ++found->second->running;
      return Lease(this, found->second);
    }
  }
  return ClosedOrUnknown(id);
}

Status SessionManager::ClosedOrUnknown(const SessionId& id) const {
  const Result<Session> session = store_->GetSession(id);
  if (session.ok()) {
    return FailedPrecondition("SESSION_CLOSED", "session '" + id + "' has ended; start a new one");
  }
  return session.status().code() == StatusCode::kNotFound ? SessionNotFound(id) : session.status();
}

std::size_t SessionManager::unsaved_observations() const {
  const std::lock_guard lock(mutex_);
  return unsaved_;
}

double SessionManager::unsaved_age_s() const {
  const std::int64_t now_ns = clock_.NowUnixNanos();
  std::int64_t oldest_ns = now_ns;
  const std::lock_guard lock(mutex_);
  for (const auto& [id, open] : open_) {
    if (!open->unsaved.empty()) {
      oldest_ns = std::min(oldest_ns, open->unsaved.front().time_unix_ns);
    }
  }
  return 1e-9 * static_cast<double>(now_ns - oldest_ns);
}

std::size_t SessionManager::open_sessions() const {
  const std::lock_guard lock(mutex_);
  return open_.size();
}

}  // namespace maploc
