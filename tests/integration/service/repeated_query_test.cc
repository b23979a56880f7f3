// A query in a session that is sent again: the same answer, counted once.
#include <thread>
#include <vector>

#include <grpcpp/grpcpp.h>

#include "maploc/v1/localization_service.grpc.pb.h"
#include "proto/convert/convert.h"
#include "server/sessions/answered_queries.h"
#include "tests/integration/service/service_fixture.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

struct Answer {
  grpc::Status status;
  std::string bytes;  // of the response
  std::string reason;
  bool has_retry_time = false;
};

class RepeatedQueryTest : public ServiceTest {
 protected:
  static v1::LocalizeRequest Named(const std::string& id, const Query& query) {
    v1::LocalizeRequest request;
    QueryToProto(query, /*include_matches=*/true, &request);
    request.set_request_id(id);
    return request;
  }
  // As a robot sends it that repeats nothing by itself.
  Answer Send(const v1::LocalizeRequest& request) const {
    const auto stub = v1::LocalizationService::NewStub(
        grpc::CreateChannel(Address(), grpc::InsecureChannelCredentials()));
    grpc::ClientContext context;
    v1::LocalizeResponse response;
    Answer answer;
    answer.status = stub->Localize(&context, request, &response);
    answer.bytes = response.SerializeAsString();
    const auto& trailers = context.GetServerTrailingMetadata();
    if (const auto reason = trailers.find("maploc-reason"); reason != trailers.end()) {
      answer.reason.assign(reason->second.data(), reason->second.size());
    }
    answer.has_retry_time = trailers.contains("grpc-retry-pushback-ms");
    return answer;
  }
  std::size_t Written(const SessionId& session) const {
    return store_->ListObservations(session)->size();
  }
};

TEST_F(RepeatedQueryTest, GetsTheSameAnswerAlsoAfterItWasWrittenDown) {
  const SessionId session = StartSession();
  const v1::LocalizeRequest request = Named("q", QueryAt(2.0, session));
  const Answer first = Send(request);
  ASSERT_TRUE(first.status.ok()) << first.status.error_message();
  EXPECT_EQ(Send(request).bytes, first.bytes);
  ASSERT_TRUE(WaitFor([&] { return Written(session) == 1; }));
  EXPECT_EQ(Send(request).bytes, first.bytes) << "to the stage times";
  EXPECT_NE(Send(Named("r", QueryAt(2.0, session))).bytes, first.bytes);
  EXPECT_EQ(client_->EndSession(session)->queries, 2);
  EXPECT_EQ(CountedQueries(), 2);
}

// The server has forgotten the answer, and the store knows the query.
TEST_F(RepeatedQueryTest, IsAnsweredAfterARestartAndNotCountedAgain) {
  const SessionId session = StartSession();
  const v1::LocalizeRequest request = Named("q", QueryAt(2.0, session));
  ASSERT_TRUE(Send(request).status.ok());
  RestartServer();
  ASSERT_TRUE(Send(request).status.ok());
  ASSERT_TRUE(Send(Named("r", QueryAt(4.0, session))).status.ok());
  EXPECT_EQ(client_->EndSession(session)->queries, 2);
  EXPECT_EQ(CountedQueries(), 2);
}

TEST_F(RepeatedQueryTest, AnotherRequestUnderItsIdIsRefused) {
  const SessionId session = StartSession();
  ASSERT_TRUE(Send(Named("q", QueryAt(2.0, session))).status.ok());
  v1::LocalizeRequest other = Named("q", QueryAt(2.0, session));
  std::string& descriptors = *other.mutable_views(0)->mutable_points()->mutable_descriptors();
  descriptors.back() = static_cast<char>(descriptors.back() ^ 1);
  const Answer refused = Send(other);
  EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(refused.reason, "REQUEST_ID_REUSED");
  EXPECT_FALSE(refused.has_retry_time);
  EXPECT_EQ(client_->EndSession(session)->queries, 1);
}

// A robot that was started anew numbers its queries from 1 again, in the session that it had.
TEST_F(RepeatedQueryTest, AnIdThatNamesAnotherQueryLaterLosesNone) {
  const SessionId session = StartSession();
  const v1::LocalizeRequest first = Named("1", QueryAt(2.0, session));
  ASSERT_TRUE(Send(first).status.ok());
  for (std::size_t i = 0; i < kAnswersOfSession; ++i) {
    ASSERT_TRUE(Send(Named("photo " + std::to_string(i), QueryAt(2.0, session))).status.ok());
  }
  ASSERT_TRUE(Send(Named("1", QueryAt(4.0, session))).status.ok());
  RestartServer();
  ASSERT_TRUE(Send(first).status.ok());
  EXPECT_EQ(client_->EndSession(session)->queries, static_cast<int>(kAnswersOfSession) + 2);
}

TEST_F(RepeatedQueryTest, ManyAtOnceAreOneQuery) {
  const SessionId session = StartSession();
  const v1::LocalizeRequest request = Named("q", QueryAt(2.0, session));
  std::vector<Answer> answers(12);
  std::vector<std::thread> robots;
  for (Answer& answer : answers) {
    robots.emplace_back([&] { answer = Send(request); });
  }
  for (std::thread& robot : robots) robot.join();
  const std::string kept = Send(request).bytes;
  for (const Answer& answer : answers) {
    if (answer.status.ok()) {
      EXPECT_EQ(answer.bytes, kept);
    } else {
      EXPECT_EQ(answer.reason, "QUERY_RUNNING");
      EXPECT_TRUE(answer.has_retry_time);
    }
  }
  EXPECT_EQ(client_->EndSession(session)->queries, 1);
}

// A name that robots give their queries anyway does not make one query of them.
TEST_F(RepeatedQueryTest, OutsideOfSessionsAnIdIsAMereName) {
  Query query = QueryAt(2.0);
  EXPECT_TRUE(Send(Named("q", query)).status.ok());
  EXPECT_TRUE(Send(Named("q", QueryAt(4.0))).status.ok());
}

}  // namespace
}  // namespace maploc::testing
