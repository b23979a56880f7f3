// What was answered under a request_id in a session, so that a repeated query gets the same answer
// and counts once. Kept in memory: the last kAnswersOfSession of each session, at most kAnswerBytes
// of all. Of what is not kept any more the store still knows that it was counted
// (Observation::counted_as), so that a repeat is worked on anew and counts nothing.
//
// Thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "mapstore/base/ids.h"
#include "mapstore/base/status.h"
#include "mapstore/model/localization.h"

namespace maploc {

inline constexpr std::size_t kAnswersOfSession = 64;
inline constexpr std::size_t kAnswerBytes = 32 << 20;

class AnsweredQueries {
 public:
  using Answer = std::shared_ptr<const Localization>;

  // A query's place under its request_id. While it lives without an answer, repeats of the query
  // are refused. Move-only; must not outlive the AnsweredQueries.
  class Turn {
   public:
    Turn() = default;  // of a query that cannot be repeated
    Turn(Turn&& other) noexcept
        : queries_(std::exchange(other.queries_, nullptr)),
          session_(std::move(other.session_)),
          request_id_(std::move(other.request_id_)),
          repeated_(std::move(other.repeated_)) {}
    Turn& operator=(Turn&&) = delete;
    ~Turn();

    // The answer that the query got before; null: it is to be worked on.
    const Answer& repeated() const { return repeated_; }
    // From now on repeats get this answer. REQUIRES: repeated() is null; called at most once.
    void Keep(Localization answer);

   private:
    friend class AnsweredQueries;
    AnsweredQueries* queries_ = nullptr;  // null: nothing is kept
    SessionId session_;
    std::string request_id_;
    Answer repeated_;
  };

  // `payload` identifies the whole request. INVALID_ARGUMENT (REQUEST_ID_REUSED) for another one
  // than the request_id came with before; UNAVAILABLE (QUERY_RUNNING) while the first one runs.
  Result<Turn> Begin(const SessionId& session, const std::string& request_id,
                     std::uint64_t payload);

  std::size_t bytes() const;

 private:
  struct Entry {
    std::uint64_t payload = 0;
    Answer answer;  // null: it is worked on
    std::size_t bytes = 0;
  };
  struct OfSession {
    std::map<std::string, Entry> entries;         // by request_id
    std::map<std::uint64_t, std::string> by_age;  // the answered ones
  };

  void Keep(const Turn& turn, Answer answer);
  void Abandon(const Turn& turn);
  // REQUIRES: mutex_ is held (both).
  void Forget(std::uint64_t age);
  void EraseIfEmpty(const SessionId& session);

  mutable std::mutex mutex_;  // guards all below
  std::map<SessionId, OfSession> sessions_;
  std::map<std::uint64_t, SessionId> by_age_;  // the answered ones of all sessions
  std::uint64_t next_age_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace maploc
