// A robot that asks again until it is acknowledged, and keeps a ledger of what it was told.
#pragma once

#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "client/api/client.h"
#include "mapstore/model/query.h"
#include "mapstore/model/session.h"

namespace maploc::testing {

class StubbornRobot {
 public:
  // `queries` outlive the robot.
  explicit StubbornRobot(const std::vector<Query>& queries) : queries_(queries) {}

  // Sessions of three queries, one after the other, until `stop`.
  void Work(const std::string& address, const std::atomic<bool>& stop) {
    const Client client(address, OneAttempt());
    while (!stop) Step(client);
  }
  // Ends the session that is open; what it is told is the last entry of acknowledged().
  Status EndOpenSession(const std::string& address) {
    return running_ ? End(Client(address, OneAttempt())) : Status::Ok();
  }

  // While it works: sessions that were acknowledged, and refusals of each call by reason.
  int acknowledged_so_far() const { return acknowledged_so_far_; }
  std::map<std::string, int> Refusals(const std::string& call) const {
    const std::lock_guard lock(mutex_);
    const auto found = refusals_.find(call);
    return found == refusals_.end() ? std::map<std::string, int>() : found->second;
  }
  // While it does not work: each acknowledged EndSession, with the answers that were counted.
  struct Ended {
    SessionId session;
    int answered = 0;
    std::int64_t acknowledged = 0;  // queries, as EndSession says
  };
  const std::vector<Ended>& acknowledged() const { return acknowledged_; }

 private:
  static constexpr int kQueries = 3;

  static ClientOptions OneAttempt() {
    ClientOptions options;
    options.max_attempts = 1;
    return options;
  }
  void Step(const Client& client) {
    if (!running_) {
      const Result<SessionId> id = client.StartSession("street", "rover", {});
      Note("StartSession", id.status());
      if (id.ok()) running_ = Ended{*id, 0, 0};
    } else if (running_->answered < kQueries) {
      Query query = queries_[acknowledged_.size() % queries_.size()];
      query.session = running_->session;
      const Status status = client.Localize(query).status();
      Note("Localize", status);
      if (status.ok()) ++running_->answered;
    } else {
      Note("EndSession", End(client));
    }
  }
  Status End(const Client& client) {
    const Result<SessionSummary> summary = client.EndSession(running_->session);
    if (!summary.ok()) return summary.status();
    running_->acknowledged = summary->queries;
    acknowledged_.push_back(*running_);
    running_.reset();
    ++acknowledged_so_far_;
    return Status::Ok();
  }
  void Note(const std::string& call, const Status& status) {
    if (status.ok()) return;
    const std::lock_guard lock(mutex_);
    ++refusals_[call][status.reason()];
  }

  const std::vector<Query>& queries_;
  std::optional<Ended> running_;
  std::vector<Ended> acknowledged_;
  std::atomic<int> acknowledged_so_far_ = 0;
  mutable std::mutex mutex_;
  std::map<std::string, std::map<std::string, int>> refusals_;
};

}  // namespace maploc::testing
