// What reaches the store after the answers: groups of observations, and ends of sessions.
#include <algorithm>

#include <spdlog/spdlog.h>

#include "mapstore/base/wait_limit.h"
#include "server/sessions/caught.h"
#include "server/sessions/open_session.h"
#include "server/sessions/session_manager.h"

namespace maploc {
namespace {

// Observations a transaction, about: some 20 ms, so that an EndSession does not wait longer for
// one.
constexpr std::size_t kMaxGroup = 2000;

// A store that is busy, full or broken refuses everybody, whatever is written.
bool IsOfTheStore(const Status& status) {
  return status.code() == StatusCode::kUnavailable ||
         status.code() == StatusCode::kResourceExhausted;
}

}  // namespace

void SessionManager::Run() {
  Health& health = options_.health != nullptr ? *options_.health : own_health_;
  // A stop must not wait for another process that holds the store.
  const WaitLimit until_stop(kNoDeadline, &stopping_);
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    changed_.wait_for(lock, options_.flush_interval, [this] { return stopping_.load(); });
    lock.unlock();
    health.Run("statistics, which stay in memory until they can be written",
               [this] { return WriteRound(); });
    health.Run("sessions that have been idle too long", [this] { return CloseIdle(); });
    lock.lock();
  }
}

// Where nothing waits, but a start or an end was refused, it is tried whether the store takes
// anything (a transaction without rows is written to disk, too): health is to say so until it does.
Status SessionManager::WriteRound() {
  const bool was_refused = refused_.exchange(false);
  Status status = Flush();
  if (status.ok() && was_refused) status = store_->AppendGroup({}).status();
  if (!status.ok() && was_refused) refused_ = true;
  return WithBacklog(status);
}

Status SessionManager::Flush() {
  const std::lock_guard flush_lock(flush_mutex_);
  Status first_error;
  for (const std::vector<Batch>& group : Waiting()) {
    const Status status = FlushGroup(group);
    if (first_error.ok()) first_error = status;
  }
  return first_error;
}

// At half of the limit, so that an operator hears of it before Enter refuses robots. Whatever the
// failure is, and however short it lasts.
Status SessionManager::WithBacklog(const Status& status) const {
  const std::lock_guard lock(mutex_);
  if (status.ok() || unsaved_ < options_.max_unsaved_observations / 2) return status;
  return Status(StatusCode::kUnavailable, "STATISTICS_BACKLOG",
                std::to_string(unsaved_) + " observations wait, of " +
                    std::to_string(options_.max_unsaved_observations) +
                    " at most: " + status.message());
}

void SessionManager::NoteRefusal(const Status& status) {
  if (IsOfTheStore(status)) refused_ = true;
}

std::vector<std::vector<SessionManager::Batch>> SessionManager::Waiting() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::vector<Batch>> groups;
  std::size_t size = kMaxGroup;  // of the last group
  for (const auto& [id, open] : open_) {
    // An end takes the rest along in its own transaction (Finish). It does so when the last query
    // is done, and until then a crash must not cost what waits.
    const bool is_being_ended = open->ending && open->running == 0;
    if (open->unsaved.empty() || is_being_ended) continue;
    if (size >= kMaxGroup) {
      groups.emplace_back();
      size = 0;
    }
    groups.back().push_back({open, open->unsaved});
    size += open->unsaved.size();
  }
  return groups;
}

Status SessionManager::FlushGroup(const std::vector<Batch>& group) {
  std::vector<SessionObservations> observations;
  for (const Batch& batch : group) {
    observations.push_back({batch.open->session.id, batch.observations});
  }
  const Result<std::vector<SessionId>> ended = store_->AppendGroup(observations);
  if (!ended.ok()) return group.size() > 1 ? FlushOneByOne(group, ended.status()) : ended.status();
  for (const Batch& batch : group) {
    EraseSaved(batch.open, batch.observations.back().sequence);
    if (std::ranges::count(*ended, batch.open->session.id) > 0) DropEnded(batch);
  }
  return Status::Ok();
}

// What the store refuses of one session must not hold up the others. Where it refuses everybody
// asking again for each would only take longer.
Status SessionManager::FlushOneByOne(const std::vector<Batch>& group, const Status& refused) {
  if (IsOfTheStore(refused)) return refused;
  for (const Batch& batch : group) static_cast<void>(FlushGroup({batch}));
  return refused;
}

void SessionManager::DropEnded(const Batch& batch) {
  const std::lock_guard lock(mutex_);
  if (batch.open->ending) return;  // our own End was faster, and took these along
  spdlog::warn("session {} was ended by another process; {} observations came too late",
               batch.open->session.id, batch.observations.size());
  lost_ += batch.observations.size();
  Drop(batch.open);
}

void SessionManager::EraseSaved(const std::shared_ptr<Open>& open, std::int64_t last_sequence) {
  const std::lock_guard lock(mutex_);
  unsaved_ -= std::erase_if(open->unsaved, [last_sequence](const Observation& observation) {
    return observation.sequence <= last_sequence;
  });
}

bool SessionManager::Wait(std::unique_lock<std::mutex>& lock, Deadline deadline,
                          const std::function<bool()>& condition) {
  if (deadline != kNoDeadline) return changed_.wait_until(lock, deadline, condition);
  changed_.wait(lock, condition);
  return true;
}

Result<std::shared_ptr<SessionManager::Open>> SessionManager::Claim(const SessionId& id,
                                                                    Deadline deadline) {
  const Status late(StatusCode::kDeadlineExceeded, "SESSION_BUSY",
                    "queries of session '" + id + "' are still running; end it again");
  std::unique_lock lock(mutex_);
  const auto nobody_ends_it = [&] {
    const auto found = open_.find(id);
    return found == open_.end() || !found->second->ending;
  };
  if (!Wait(lock, deadline, nobody_ends_it)) return late;
  const auto found = open_.find(id);
  if (found == open_.end()) return std::shared_ptr<Open>();
  const std::shared_ptr<Open> open = found->second;
  open->ending = true;
  // No query enters from here on, so that those that run come to an end.
  if (Wait(lock, deadline, [&] { return open->running == 0; })) return open;
  open->ending = false;
  changed_.notify_all();
  return late;
}

Result<SessionSummary> SessionManager::End(const SessionId& id, Deadline deadline) {
  MAPLOC_ASSIGN_OR_RETURN(const std::shared_ptr<Open> open, Claim(id, deadline));
  return open == nullptr ? EndInStore(id) : Finish(open, SessionEnd::kByRobot);
}

Result<SessionSummary> SessionManager::EndInStore(const SessionId& id) const {
  Result<SessionSummary> summary =
      store_->EndSession(id, SessionEnd::kByRobot, clock_.NowUnixNanos(), {});
  if (summary.ok() || summary.status().code() != StatusCode::kNotFound) return summary;
  return NotFound("session '" + id + "'", "SESSION_NOT_FOUND");
}

Result<SessionSummary> SessionManager::Finish(const std::shared_ptr<Open>& open, SessionEnd end) {
  // Nobody records any more. What a flush is writing at this moment counts once all the same: the
  // store knows each observation by its sequence.
  std::vector<Observation> last;
  {
    const std::lock_guard lock(mutex_);
    last = open->unsaved;
  }
  // Whatever happens, the session must not stay claimed.
  Result<SessionSummary> summary = Caught(
      [&] { return store_->EndSession(open->session.id, end, clock_.NowUnixNanos(), last); });
  NoteRefusal(summary.status());
  {
    const std::lock_guard lock(mutex_);
    if (summary.ok()) {
      Drop(open);
    } else {
      open->ending = false;
    }
  }
  changed_.notify_all();
  return summary;
}

void SessionManager::Drop(const std::shared_ptr<Open>& open) {
  open->gone = true;
  unsaved_ -= open->unsaved.size();
  open->unsaved.clear();
  open_.erase(open->session.id);
}

Status SessionManager::CloseIdle() {
  if (options_.idle_timeout.count() == 0) return Status::Ok();
  const auto oldest = clock_.SteadyNow() - options_.idle_timeout;
  std::vector<std::shared_ptr<Open>> idle;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, open] : open_) {
      if (open->ending || open->running > 0 || open->last_activity > oldest) continue;
      open->ending = true;
      idle.push_back(open);
    }
  }
  Status first_error;
  for (const std::shared_ptr<Open>& open : idle) {
    const Result<SessionSummary> summary = Finish(open, SessionEnd::kIdle);
    if (summary.ok()) {
      spdlog::info("session {} ended: idle, {} queries", open->session.id, summary->queries);
    } else if (first_error.ok()) {
      first_error = summary.status().WithContext("session " + open->session.id);
    }
  }
  return first_error;
}

void SessionManager::StopThread() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  std::call_once(joined_, [this] {
    if (thread_.joinable()) thread_.join();
  });
}

Status SessionManager::Shutdown() {
  // First, because an idle session that the thread fails to end has something to be written again.
  StopThread();
  return Flush();
}

}  // namespace maploc
