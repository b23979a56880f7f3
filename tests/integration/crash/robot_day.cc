#include "tests/integration/crash/robot_day.h"

#include <gtest/gtest.h>

namespace maploc::testing {
namespace {

// Short sessions, so that many ends are asked for; and long ones that are still open when the
// server dies, so that what is lost shows.
constexpr int kShort = 40;
constexpr int kLong = 1000;

// A dead server is noticed at once, and nothing is repeated behind the ledger's back.
ClientOptions OneAttempt() {
  ClientOptions options;
  options.max_attempts = 1;
  options.call_timeout = std::chrono::seconds(60);
  return options;
}

}  // namespace

bool RobotDay::Served(const Status& status, const char* call) {
  if (status.ok()) return true;
  EXPECT_EQ(status.code(), StatusCode::kUnavailable) << call << ": " << status.ToString();
  return false;
}

void RobotDay::WorkUntilTheServerDies(const std::string& address) {
  const Client client(address, OneAttempt());
  while (true) {
    if (!running_ && !Begin(client)) return;
    while (!running_->end_was_asked && running_->Known() < running_->planned) {
      if (!Ask(client)) return;
    }
    if (!End(client)) return;
  }
}

bool RobotDay::Begin(const Client& client) {
  const Result<SessionId> id = client.StartSession("street", name_, {{"season", "autumn"}});
  if (!Served(id.status(), "StartSession")) return false;
  running_.emplace();
  running_->id = *id;
  running_->planned = static_cast<int>(1 + random_.Below(random_.Below(2) == 0 ? kShort : kLong));
  return true;
}

bool RobotDay::Ask(const Client& client) {
  Query query = queries_[random_.Below(static_cast<std::uint32_t>(queries_.size()))];
  query.session = running_->id;
  const Result<Localization> answer = client.Localize(query);
  if (!Served(answer.status(), "Localize")) {
    ++running_->unanswered;
    return false;
  }
  running_->answered.push_back(std::chrono::steady_clock::now());
  return true;
}

bool RobotDay::End(const Client& client) {
  running_->end_was_asked = true;
  const Result<SessionSummary> summary = client.EndSession(running_->id);
  if (!Served(summary.status(), "EndSession")) return false;
  EXPECT_EQ(summary->queries, running_->Known()) << "session " << running_->id;
  ended_.emplace(running_->id, *summary);
  running_.reset();
  return true;
}

}  // namespace maploc::testing
