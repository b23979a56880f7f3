// What an operator's Prometheus sees of a server.
#include <cerrno>

#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/integration/service/metrics_fixture.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

TEST_F(MetricsTest, CountsCallsAndAnswers) {
  const SessionId session = StartSession();
  for (const double x : {2.0, 8.0, 14.0}) ASSERT_TRUE(client_->Localize(QueryAt(x, session)).ok());
  Query elsewhere = QueryAt(8.0);
  elsewhere.map = "no such map";
  ASSERT_FALSE(client_->Localize(elsewhere).ok());

  auto samples = Scrape();
  EXPECT_EQ(samples[R"(maploc_calls_total{code="OK",method="Localize"})"], 3);
  EXPECT_EQ(samples[R"(maploc_calls_total{code="NOT_FOUND",method="Localize"})"], 1);
  EXPECT_EQ(samples[R"(maploc_calls_total{code="OK",method="StartSession"})"], 1);
  EXPECT_EQ(samples[R"(maploc_call_seconds_count{method="Localize"})"], 4);
  EXPECT_EQ(samples[R"(maploc_answers_total{map="street",outcome="LOCALIZED",strategy="mixed"})"],
            3);
  EXPECT_EQ(samples[R"(maploc_stage_seconds_count{stage="matching"})"], 3);
  EXPECT_EQ(samples[R"(maploc_point_inlier_ratio_count{map="street"})"], 3);
  EXPECT_EQ(samples[R"(maploc_line_inlier_ratio_count{map="street"})"], 3);
  EXPECT_EQ(samples[R"(maploc_gravity_disagreement_radians_count{map="street"})"], 3);
  EXPECT_EQ(samples[R"(maploc_wait_seconds_count{method="Localize"})"], 4);
  EXPECT_EQ(
      samples
          [R"(maploc_refused_calls_total{code="NOT_FOUND",method="Localize",reason="MAP_NOT_FOUND"})"],
      1);
  EXPECT_GT(samples["maploc_segment_cache_bytes"], 0);
  EXPECT_GT(samples["maploc_segment_cache_loads_total"], 0);
  EXPECT_GT(samples["maploc_segment_cache_hits_total"], 0);
  EXPECT_GT(samples["maploc_localizations_limit"], 0);
  EXPECT_EQ(samples["maploc_open_sessions"], 1);
  EXPECT_EQ(samples["maploc_healthy"], 1);
  EXPECT_EQ(samples.count(R"(maploc_answers_total{map="no such map"})"), 0u);

  ASSERT_TRUE(client_->EndSession(session).ok());
  samples = Scrape();
  EXPECT_EQ(samples["maploc_open_sessions"], 0);
  EXPECT_EQ(samples["maploc_unsaved_observations"], 0);
}

TEST_F(MetricsTest, AGravityThatTheMatchesContradictShows) {
  Query query = QueryAt(8.0);
  query.gravity = Gravity{Eigen::Vector3d(1, 0, 0), 0.01};  // the camera's right
  ASSERT_TRUE(client_->Localize(query).ok());
  EXPECT_EQ(Scrape()[R"(maploc_gravity_rejected_total{map="street"})"], 1);
}

TEST_F(MetricsTest, HealthIsThatOfTheServer) {
  EXPECT_EQ(Get("/healthz").code, 200);
  std::filesystem::remove(folder_.File("store"));  // what it learns from now on would be lost
  EXPECT_TRUE(WaitFor([&] { return Get("/healthz").code == 503; }));
  EXPECT_EQ(Scrape()["maploc_healthy"], 0);
}

// A supervisor ends a server whose health nobody tells.
TEST_F(MetricsTest, AProbeDoesNotWaitForThoseWhoSendNothing) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(server_->metrics_port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::vector<int> silent;
  for (int i = 0; i < 20; ++i) {
    silent.push_back(socket(AF_INET, SOCK_STREAM, 0));
    ASSERT_EQ(connect(silent.back(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  EXPECT_EQ(Get("/healthz").code, 200);
  int still_open = 0;
  for (const int fd : silent) {
    char byte = 0;
    still_open += recv(fd, &byte, 1, MSG_DONTWAIT) < 0 && errno == EAGAIN ? 1 : 0;
    close(fd);
  }
  EXPECT_GT(still_open, 10) << "the probe was answered after they were given up";
}

TEST_F(MetricsTest, NothingElseIsServed) {
  for (const char* path : {"/", "/metrics/x", "/../etc/passwd", "/healthzz"}) {
    EXPECT_EQ(Get(path).code, 404) << path;
  }
}

TEST_F(MetricsTest, AnAddressThatIsTakenIsToldAtTheStart) {
  ServerOptions second;
  second.store = folder_.File("other");
  second.listen = "127.0.0.1:0";
  second.metrics_listen = "127.0.0.1:" + std::to_string(server_->metrics_port());
  const auto started = Server::Start(second);
  ASSERT_FALSE(started.ok());
  EXPECT_EQ(started.status().reason(), "CANNOT_LISTEN");
  EXPECT_THAT(started.status().message(), ::testing::HasSubstr(second.metrics_listen));
}

}  // namespace
}  // namespace maploc::testing
