#include "client/robot/load.h"

#include <algorithm>
#include <exception>
#include <future>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

namespace maploc {
namespace {

using Moment = std::chrono::steady_clock::time_point;
using Seconds = std::chrono::duration<double>;

double MillisecondsSince(Moment start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

ClientOptions OneAttempt(ClientOptions options) {
  options.max_attempts = 1;
  return options;
}

// One robot, in a thread of its own.
class LoadRobot {
 public:
  LoadRobot(const std::string& server, const std::string& map, const std::vector<Query>& queries,
            const LoadOptions& options, int index)
      : client_(server, options.client),
        impatient_(server, OneAttempt(options.client)),
        map_(map),
        queries_(queries),
        options_(options),
        index_(index) {}

  void Run(Moment start) {
    for (std::int64_t i = 0; status_.ok(); ++i) {
      const Seconds after = Due(start, i);
      // Before the cast: at a tiny rate the next query is further off than a clock counts.
      if (after >= options_.duration) break;
      const Moment due = start + std::chrono::duration_cast<Moment::duration>(after);
      if (!WaitUntil(due)) break;
      if (options_.sessions && session_.empty()) status_ = StartSession();
      // At a rate the latency counts from the moment when the query was due. Counted from when it
      // was sent, a server that stalls would hide the wait of those that could not be sent
      // meanwhile.
      if (status_.ok())
        Ask(i, options_.rate_per_second > 0 ? due : std::chrono::steady_clock::now());
      if (asked_ == options_.queries_a_session) EndSession();
    }
    if (status_.ok()) EndSession();
  }

  const Status& status() const { return status_; }
  LoadReport& report() { return report_; }

 private:
  // When, after the start, the i-th query of this robot is to be sent; robots take turns.
  Seconds Due(Moment start, std::int64_t i) const {
    // Without a rate a query is due as soon as the one before it is answered.
    if (options_.rate_per_second <= 0) return std::chrono::steady_clock::now() - start;
    return Seconds(static_cast<double>(i * options_.robots + index_) / options_.rate_per_second);
  }

  // In short steps, so that a stop is not slept through; false: a stop was asked for.
  bool WaitUntil(Moment due) const {
    constexpr auto kStep = std::chrono::milliseconds(100);
    const auto stopped = [this] { return options_.stop && options_.stop(); };
    for (Moment now = std::chrono::steady_clock::now(); now < due && !stopped();
         now = std::chrono::steady_clock::now()) {
      std::this_thread::sleep_for(std::min<Moment::duration>(kStep, due - now));
    }
    return !stopped();
  }

  Status StartSession() {
    MAPLOC_ASSIGN_OR_RETURN(session_,
                            client_.StartSession(map_, "load-" + std::to_string(index_), {}));
    asked_ = 0;
    return Status::Ok();
  }

  void Ask(std::int64_t i, Moment since) {
    // Each robot begins with another query, so that not all ask for one segment at the same time.
    Query query = queries_[static_cast<std::size_t>(i + index_) % queries_.size()];
    query.map = map_;
    query.session = session_;
    query.request_id.clear();  // it is asked more than once
    // Sent once: a refusal is what a load is to count. A client that waited it out would report a
    // slow server instead of a full one.
    const Result<Localization> answer = impatient_.Localize(query);
    ++report_.requests;
    ++asked_;
    if (answer.ok()) {
      report_.latencies_ms.push_back(MillisecondsSince(since));
      ++report_.outcomes[answer->outcome];
      report_.gravity_rejected += answer->evidence.gravity_rejected ? 1 : 0;
    } else {
      ++report_.errors[std::string(StatusCodeName(answer.status().code()))];
    }
  }

  void EndSession() {
    if (session_.empty()) return;
    const Moment start = std::chrono::steady_clock::now();
    const SessionId session = std::exchange(session_, {});
    const Result<SessionSummary> summary = client_.EndSession(session);
    status_ = summary.status().WithContext("session " + session + ", which may be open still");
    if (summary.ok()) report_.end_session_ms.push_back(MillisecondsSince(start));
  }

  const Client client_;
  const Client impatient_;  // for queries, which are sent once
  const std::string& map_;
  const std::vector<Query>& queries_;
  const LoadOptions& options_;
  const int index_;
  SessionId session_;
  int asked_ = 0;
  Status status_;
  LoadReport report_;
};

void Append(const std::vector<double>& from, std::vector<double>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

void Add(const LoadReport& one, LoadReport& all) {
  all.requests += one.requests;
  all.gravity_rejected += one.gravity_rejected;
  Append(one.latencies_ms, all.latencies_ms);
  Append(one.end_session_ms, all.end_session_ms);
  for (const auto& [outcome, count] : one.outcomes) all.outcomes[outcome] += count;
  for (const auto& [code, count] : one.errors) all.errors[code] += count;
}

// All robots begin at one moment, when each has its thread. Where the system gives no more threads
// none begins, so that no session is open then.
Status RunTogether(const std::vector<std::unique_ptr<LoadRobot>>& robots, Moment* start) {
  std::promise<std::optional<Moment>> go;
  const std::shared_future<std::optional<Moment>> begin = go.get_future().share();
  // Behind what the threads use, so that it is destroyed, and they are joined, first.
  std::vector<std::jthread> threads;
  try {
    for (const auto& robot : robots) {
      threads.emplace_back([&robot, begin] {
        if (begin.get()) robot->Run(*begin.get());
      });
    }
  } catch (const std::exception& error) {
    go.set_value(std::nullopt);
    return ResourceExhausted("TOO_MANY_THREADS",
                             "the system gave threads to " + std::to_string(threads.size()) +
                                 " of " + std::to_string(robots.size()) +
                                 " robots; lower --robots (" + error.what() + ")");
  }
  *start = std::chrono::steady_clock::now();
  go.set_value(*start);
  return Status::Ok();
}

}  // namespace

Result<LoadReport> RunLoad(const std::string& server, const std::string& map,
                           const std::vector<Query>& queries, const LoadOptions& options) {
  std::vector<std::unique_ptr<LoadRobot>> robots;
  for (int i = 0; i < options.robots; ++i) {
    robots.push_back(std::make_unique<LoadRobot>(server, map, queries, options, i));
  }
  Moment start;
  MAPLOC_RETURN_IF_ERROR(RunTogether(robots, &start));

  LoadReport report;
  report.elapsed = std::chrono::steady_clock::now() - start;
  for (const auto& robot : robots) {
    MAPLOC_RETURN_IF_ERROR(robot->status());
    Add(robot->report(), report);
  }
  return report;
}

}  // namespace maploc
