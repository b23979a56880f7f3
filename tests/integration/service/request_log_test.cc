// Which requests have a line, and what a client cannot do to it.
#include "server/service/request_log.h"

#include <future>
#include <sstream>

#include <gmock/gmock.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/ostream_sink.h>

#include "server/service/traceparent.h"
#include "tests/support/fake_clock.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace std::chrono_literals;

class RequestLogTest : public ::testing::Test {
 protected:
  RequestLogTest() {
    options_.every = 0;
    facts_.robot = "rover";
    facts_.outcome = Outcome::kLocalized;
    facts_.times.ransac_ms = 7.25;
    Open();
  }

  void Open() {
    log_.reset();
    text_.str("");
    log_ = std::make_unique<RequestLog>(
        options_, std::make_shared<spdlog::sinks::ostream_sink_mt>(text_), clock_);
  }
  void Write(const Status& status, double total_ms = 1.0) {
    log_->Write({"Localize", status, "", facts_, 0.5, total_ms});
  }
  // Ends the log.
  std::vector<std::string> Lines() {
    log_.reset();
    std::vector<std::string> lines;
    std::istringstream text(text_.str());
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
  }

  static Status Refused(const std::string& reason) { return ResourceExhausted(reason, "no"); }

  RequestLogOptions options_;
  FakeClock clock_;
  RequestFacts facts_;
  std::ostringstream text_;
  std::unique_ptr<RequestLog> log_;
};

TEST_F(RequestLogTest, OfGoodAndFastOnesEachNthHasALine) {
  options_.every = 10;
  Open();
  for (int i = 0; i < 30; ++i) Write(Status::Ok());
  EXPECT_EQ(Lines().size(), 3u);
}

TEST_F(RequestLogTest, SlowOnesHaveALineWithTheTimesOfTheStages) {
  options_.slow_ms = 50.0;
  Open();
  Write(Status::Ok(), 49.0);
  Write(Status::Ok(), 51.0);
  EXPECT_THAT(Lines(), ElementsAre(AllOf(HasSubstr("[warning] request method=\"Localize\""),
                                         HasSubstr(" ms=51.0 "), HasSubstr(" ransac_ms=7.25 "),
                                         HasSubstr(" outcome=\"LOCALIZED\""))));
}

TEST_F(RequestLogTest, RefusalsOfOneKindAreCountedForAWhile) {
  for (int i = 0; i < 1000; ++i) Write(Refused("QUEUE_FULL"));
  Write(Refused("TOO_MANY_SESSIONS"));
  clock_.Advance(12s);
  Write(Refused("QUEUE_FULL"));
  Write(Refused("QUEUE_FULL"));
  const std::string count =
      "requests refused again method=\"Localize\" reason=\"QUEUE_FULL\" count=";
  const auto refusal = [](const std::string& reason) {
    return AllOf(HasSubstr("request method="), HasSubstr("reason=\"" + reason + "\""));
  };
  EXPECT_THAT(Lines(),
              ElementsAre(refusal("QUEUE_FULL"), refusal("TOO_MANY_SESSIONS"),
                          HasSubstr(count + "999"), refusal("QUEUE_FULL"), HasSubstr(count + "1")));
}

TEST_F(RequestLogTest, NoWordOfAClientForgesALine) {
  facts_.request_id = "quote\"and\\";
  Write(
      Internal(std::string("first\nsecond \x1b[2J \xe2\x80\xae \xff ") + std::string(100000, 'x')));
  const std::vector<std::string> lines = Lines();
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_LT(lines[0].size(), 2000u);
  EXPECT_THAT(lines[0], AllOf(HasSubstr("[error]"), HasSubstr("first\\nsecond \\u001b[2J \\u202e"),
                              HasSubstr("request_id=\"quote\\\"and\\\\\"")));
  EXPECT_THAT(lines[0], AllOf(Not(HasSubstr("\x1b")), Not(HasSubstr("\xe2\x80\xae"))));
}

// As a pipe whose reader has stopped.
class StuckSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::promise<void> release;

 private:
  void sink_it_(const spdlog::details::log_msg&) override { released_.wait(); }
  void flush_() override {}
  std::shared_future<void> released_ = release.get_future().share();
};

TEST_F(RequestLogTest, NobodyWaitsForALogThatIsNotRead) {
  options_.every = 1;
  const auto sink = std::make_shared<StuckSink>();
  RequestLog log(options_, sink, clock_);
  const Status ok;
  EXPECT_TRUE(WaitFor([&] {
    for (int i = 0; i < 1000; ++i) log.Write({"Localize", ok, "", facts_, 0.5, 1.0});
    return log.lost_lines() >= 100;
  }));
  sink->release.set_value();
}

TEST(TraceparentTest, OnlyWhatW3CCallsValidIsTaken) {
  const std::string good = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";
  EXPECT_EQ(ParseTraceparent(good), good);
  std::string later = good;
  later[1] = '1';
  EXPECT_EQ(ParseTraceparent(later + "-what comes later"), later);
  for (const std::string& bad :
       {std::string(), good + "-", good + "0", good.substr(1), "ff" + good.substr(2),
        std::string("00-") + std::string(32, '0') + "-00f067aa0ba902b7-01",
        std::string("00-4bf92f3577b34da6a3ce929d0e0e4736-0000000000000000-01"),
        std::string("00-4BF92F3577B34DA6A3CE929D0E0E4736-00f067aa0ba902b7-01"),
        std::string("00-4bf92f3577b34da6\n3ce929d0e0e4736-00f067aa0ba902b7-01"), later + "x"}) {
    EXPECT_EQ(ParseTraceparent(bad), "") << bad;
  }
}

}  // namespace
}  // namespace maploc::testing
