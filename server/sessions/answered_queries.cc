#include "server/sessions/answered_queries.h"

namespace maploc {
namespace {

// Nodes of the maps, and what allocations cost beside their content.
constexpr std::size_t kOverheadBytes = 400;

std::size_t BytesOf(const Localization& answer, const std::string& request_id) {
  const Matches& matches = answer.matches;
  return sizeof(answer) + kOverheadBytes + 2 * request_id.size() +
         (matches.points.size() + matches.lines.size()) * (sizeof(FeatureMatch) + 1);
}

Status Reused(const std::string& request_id) {
  return InvalidArgument(
      "request_id",
      "'" + request_id + "' named another query of this session; give each query its own",
      "REQUEST_ID_REUSED");
}

Status Running(const std::string& request_id) {
  return Status(StatusCode::kUnavailable, "QUERY_RUNNING",
                "query '" + request_id + "' is being worked on; ask again");
}

}  // namespace

AnsweredQueries::Turn::~Turn() {
  if (queries_ != nullptr) queries_->Abandon(*this);
}

void AnsweredQueries::Turn::Keep(Localization answer) {
  if (queries_ == nullptr) return;
  queries_->Keep(*this, std::make_shared<const Localization>(std::move(answer)));
  queries_ = nullptr;
}

Result<AnsweredQueries::Turn> AnsweredQueries::Begin(const SessionId& session,
                                                     const std::string& request_id,
                                                     std::uint64_t payload) {
  Turn turn;
  const std::lock_guard lock(mutex_);
  // Entered at once, so that of two copies of a query that run at the same time one is refused.
  const auto [found, is_new] =
      sessions_[session].entries.try_emplace(request_id, Entry{payload, nullptr, 0});
  if (!is_new) {
    const Entry& entry = found->second;
    if (entry.payload != payload) return Reused(request_id);
    if (entry.answer == nullptr) return Running(request_id);
    turn.repeated_ = entry.answer;
    return turn;
  }
  turn.queries_ = this;
  turn.session_ = session;
  turn.request_id_ = request_id;
  return turn;
}

void AnsweredQueries::Keep(const Turn& turn, Answer answer) {
  const std::size_t bytes = BytesOf(*answer, turn.request_id_);
  const std::lock_guard lock(mutex_);
  OfSession& session = sessions_.at(turn.session_);
  Entry& entry = session.entries.at(turn.request_id_);
  entry.answer = std::move(answer);
  entry.bytes = bytes;
  bytes_ += bytes;
  session.by_age.emplace(next_age_, turn.request_id_);
  by_age_.emplace(next_age_, turn.session_);
  ++next_age_;
  if (session.by_age.size() > kAnswersOfSession) Forget(session.by_age.begin()->first);
  // It may be this one, so `session` is not used after it.
  while (bytes_ > kAnswerBytes) Forget(by_age_.begin()->first);
}

void AnsweredQueries::Abandon(const Turn& turn) {
  const std::lock_guard lock(mutex_);
  // The query was not counted, so a repeat is worked on as if it were the first.
  sessions_.at(turn.session_).entries.erase(turn.request_id_);
  EraseIfEmpty(turn.session_);
}

void AnsweredQueries::Forget(std::uint64_t age) {
  const auto found = by_age_.find(age);
  const SessionId id = found->second;
  OfSession& session = sessions_.at(id);
  const auto answered = session.by_age.find(age);
  const auto entry = session.entries.find(answered->second);
  bytes_ -= entry->second.bytes;
  session.entries.erase(entry);
  session.by_age.erase(answered);
  by_age_.erase(found);
  EraseIfEmpty(id);
}

void AnsweredQueries::EraseIfEmpty(const SessionId& session) {
  const auto found = sessions_.find(session);
  if (found->second.entries.empty()) sessions_.erase(found);
}

std::size_t AnsweredQueries::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace maploc
