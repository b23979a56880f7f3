// What a token allows, and what is refused with which code.
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include <grpcpp/grpcpp.h>

#include "maploc/v1/localization_service.grpc.pb.h"
#include "tests/integration/access/access_fixture.h"
#include "tests/support/wait_for.h"

namespace maploc::testing {
namespace {

class TokenTest : public AccessTest {
 protected:
  static std::string Code(const Status& status) {
    return std::string(StatusCodeName(status.code())) + " " + status.reason();
  }
  static Status Start(const Client& client, const std::string& map, const std::string& robot) {
    return client.StartSession(map, robot, {}).status();
  }
};

TEST_F(TokenTest, OnLoopbackWithoutTokensNobodyIsAsked) {
  StartServer();
  EXPECT_TRUE(Connect().StartSession("street", "rover", {}).ok());
}

TEST_F(TokenTest, OnceThereIsATokenEverybodyIsAskedForAGoodOne) {
  const std::string good = NewToken(Role::kRobot, "rover");
  StartServer();
  EXPECT_TRUE(ConnectAs(good).ListMaps().ok());
  EXPECT_EQ(Code(Connect().ListMaps().status()), "UNAUTHENTICATED TOKEN_MISSING");
  EXPECT_EQ(Code(ConnectAs("secret").ListMaps().status()), "UNAUTHENTICATED TOKEN_MALFORMED");
  std::string wrong = good;
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  EXPECT_EQ(Code(ConnectAs(wrong).ListMaps().status()), "UNAUTHENTICATED TOKEN_WRONG");
  std::string unknown = good;
  unknown[7] = unknown[7] == '0' ? '1' : '0';
  EXPECT_EQ(Code(ConnectAs(unknown).ListMaps().status()), "UNAUTHENTICATED TOKEN_WRONG");
}

TEST_F(TokenTest, ARevokedTokenStopsWithinASecondAndNeverOpensTheServer) {
  const std::string token = NewToken(Role::kRobot, "rover");
  StartServer();
  const Client robot = ConnectAs(token);
  const Result<SessionId> session = robot.StartSession("street", "rover", {});
  ASSERT_TRUE(session.ok());
  ASSERT_TRUE(TokenFile(options_.store).Revoke(ParseToken(token)->id).ok());
  const auto revoked = std::chrono::steady_clock::now();
  ASSERT_TRUE(WaitFor([&] {
    return Code(robot.Localize(QueryIn(*session)).status()) == "UNAUTHENTICATED TOKEN_REVOKED";
  }));
  EXPECT_LT(std::chrono::steady_clock::now() - revoked, std::chrono::seconds(1));
  EXPECT_NE(robot.ListMaps().status().message().find("token create makes another one"),
            std::string::npos);
  EXPECT_EQ(Code(Connect().ListMaps().status()), "UNAUTHENTICATED TOKEN_MISSING");
  std::filesystem::remove(TokenFile(options_.store).path());
  std::this_thread::sleep_for(2 * TokenBook::kLookEvery);  // it is looked at, and nothing follows
  EXPECT_EQ(Code(Connect().ListMaps().status()), "UNAUTHENTICATED TOKEN_MISSING");
}

// Also not by more connections: its token names it.
TEST_F(TokenTest, AGreedyRobotTakesNoOtherRobotsShareOfTheQueue) {
  options_.workers = 1;
  options_.queue = 4;
  const std::string greedy = NewToken(Role::kRobot, "greedy");
  const std::string other = NewToken(Role::kRobot, "polite");
  StartServer();
  const Client polite = ConnectAs(other);
  const Query query = QueryIn("");
  std::atomic<bool> enough = false;
  std::atomic<int> refused = 0;
  std::vector<std::thread> connections;
  for (int i = 0; i < 8; ++i) {
    connections.emplace_back([&] {
      const Client client = ConnectAs(greedy);
      while (!enough) refused += client.Localize(query).ok() ? 0 : 1;
    });
  }
  EXPECT_TRUE(WaitFor([&refused] { return refused > 0; })) << "the queue is full";
  for (int i = 0; i < 20; ++i) {
    const Status answered = polite.Localize(query).status();
    EXPECT_TRUE(answered.ok()) << answered.ToString();
  }
  enough = true;
  for (std::thread& connection : connections) connection.join();
}

TEST_F(TokenTest, ATokenIsGoodUntilItExpires) {
  const TokenFile file(options_.store);
  const Grant grant{Role::kViewer, "", {}};
  const std::string brief = TokenText(file.Create(grant, std::chrono::seconds(2)).value());
  const std::string lasting = TokenText(file.Create(grant, std::chrono::hours(1)).value());
  StartServer();
  const Client client = ConnectAs(brief);
  EXPECT_TRUE(client.ListMaps().ok());
  EXPECT_TRUE(
      WaitFor([&] { return Code(client.ListMaps().status()) == "UNAUTHENTICATED TOKEN_EXPIRED"; }));
  EXPECT_TRUE(ConnectAs(lasting).ListMaps().ok());
}

// A file that was damaged must not make a token eternal.
TEST_F(TokenTest, AnEndThatIsNoTimeIsRefused) {
  const TokenFile file(options_.store);
  ASSERT_TRUE(file.Create({Role::kViewer, "", {}}, std::chrono::hours(1)).ok());
  std::string text = ReadFile(file.path());
  const std::string field = "\"expires_unix_ns\":";
  text.insert(text.find(field) + field.size(), "\"x\",\"y\":");
  folder_.Write("store-tokens", text);
  EXPECT_EQ(RefusedStart().reason(), "INVALID_FILE");
}

TEST_F(TokenTest, ARobotWorksUnderItsNameOnItsMapsInItsSessions) {
  const Client rover_token_user = [this] {
    const std::string token = NewToken(Role::kRobot, "rover", {"street"});
    const std::string other = NewToken(Role::kRobot, "digger");
    folder_.Write("digger", other);
    StartServer();
    return ConnectAs(token);
  }();
  const Client& rover = rover_token_user;
  const Client digger = ConnectAs(folder_.Read("digger"));

  EXPECT_EQ(Code(Start(rover, "street", "digger")), "PERMISSION_DENIED ROBOT_FORBIDDEN");
  const std::string told = Start(rover, "street", "digger").message();
  EXPECT_NE(told.find("under the token's name (--robot)"), std::string::npos) << told;
  EXPECT_EQ(Code(Start(rover, "yard", "rover")), "PERMISSION_DENIED MAP_FORBIDDEN");
  EXPECT_EQ(Code(rover.GetMap("yard").status()), "PERMISSION_DENIED MAP_FORBIDDEN");
  EXPECT_EQ(Code(digger.GetMap("yard").status()), "NOT_FOUND MAP_NOT_FOUND");
  EXPECT_EQ(Code(rover.ListSegments("yard").status()), "PERMISSION_DENIED MAP_FORBIDDEN");
  EXPECT_EQ(Code(rover.GetSegment("yard", 0).status()), "PERMISSION_DENIED MAP_FORBIDDEN");
  Query elsewhere = QueryIn("");
  elsewhere.map = "yard";
  EXPECT_EQ(Code(rover.Localize(elsewhere).status()), "PERMISSION_DENIED MAP_FORBIDDEN");
  EXPECT_TRUE(rover.Localize(QueryIn("")).ok());

  const Result<SessionId> session = rover.StartSession("street", "rover", {});
  ASSERT_TRUE(session.ok()) << session.status().ToString();
  EXPECT_EQ(Code(digger.Localize(QueryIn(*session)).status()),
            "PERMISSION_DENIED SESSION_FORBIDDEN");
  EXPECT_EQ(Code(digger.EndSession(*session).status()), "PERMISSION_DENIED SESSION_FORBIDDEN");
  EXPECT_EQ(Code(digger.DiscardSession(*session).status()), "PERMISSION_DENIED SESSION_FORBIDDEN");
  ASSERT_TRUE(rover.Localize(QueryIn(*session)).ok());
  const Result<SessionSummary> summary = rover.EndSession(*session);
  ASSERT_TRUE(summary.ok()) << summary.status().ToString();
  EXPECT_EQ(summary->queries, 1);  // the refused one did not count
}

// A repeated start with the same request id is answered with the session that the first one
// opened: somebody else's must not be.
TEST_F(TokenTest, AnotherRobotsRequestIdGivesNotItsSession) {
  const std::string rover = NewToken(Role::kRobot, "rover");
  const std::string digger = NewToken(Role::kRobot, "digger");
  StartServer();
  const auto stub = v1::LocalizationService::NewStub(grpc::CreateChannel(
      "127.0.0.1:" + std::to_string(server_->port()), grpc::InsecureChannelCredentials()));
  const auto start = [&stub](const std::string& token, const std::string& robot,
                             v1::StartSessionResponse* response) {
    grpc::ClientContext context;
    context.AddMetadata("authorization", "Bearer " + token);
    v1::StartSessionRequest request;
    request.set_map("street");
    request.set_robot(robot);
    request.set_request_id("morning");
    return stub->StartSession(&context, request, response).error_code();
  };
  v1::StartSessionResponse first;
  v1::StartSessionResponse second;
  ASSERT_EQ(start(rover, "rover", &first), grpc::StatusCode::OK);
  EXPECT_EQ(start(digger, "rover", &second), grpc::StatusCode::PERMISSION_DENIED);
  ASSERT_EQ(start(digger, "digger", &second), grpc::StatusCode::OK);
  EXPECT_NE(first.session_id(), second.session_id());
}

TEST_F(TokenTest, AnOperatorEndsSessionsAndAViewerReads) {
  const std::string robot = NewToken(Role::kRobot, "rover");
  const std::string operator_token = NewToken(Role::kOperator, "");
  const std::string viewer_token = NewToken(Role::kViewer, "");
  StartServer();
  const Client operate = ConnectAs(operator_token);
  const Client view = ConnectAs(viewer_token);
  const Result<SessionId> session = ConnectAs(robot).StartSession("street", "rover", {});
  ASSERT_TRUE(session.ok());
  for (const Client* client : {&operate, &view}) {
    EXPECT_TRUE(client->GetMap("street").ok());
    EXPECT_TRUE(client->ListSegments("street").ok());
    EXPECT_EQ(Code(Start(*client, "street", "rover")), "PERMISSION_DENIED ROLE_FORBIDDEN");
    EXPECT_EQ(Code(client->Localize(QueryIn("")).status()), "PERMISSION_DENIED ROLE_FORBIDDEN");
    EXPECT_EQ(Code(client->Localize(QueryIn(*session)).status()),
              "PERMISSION_DENIED ROLE_FORBIDDEN");
  }
  EXPECT_EQ(Code(view.EndSession(*session).status()), "PERMISSION_DENIED ROLE_FORBIDDEN");
  EXPECT_TRUE(operate.DiscardSession(*session).ok());
}

TEST_F(TokenTest, MapsThatATokenIsNotForAreNotListed) {
  const std::string token = NewToken(Role::kViewer, "", {"yard"});
  StartServer();
  const Result<std::vector<RemoteMap>> maps = ConnectAs(token).ListMaps();
  ASSERT_TRUE(maps.ok());
  EXPECT_TRUE(maps->empty());
}

TEST_F(TokenTest, AClientSendsNoTokenInTheClearToAnotherMachine) {
  ClientOptions options;
  options.credentials.token = "secret";
  EXPECT_EQ(Client("192.0.2.1:50051", options).ListMaps().status().reason(), "TOKEN_IN_CLEAR");
}

TEST_F(TokenTest, AFileThatIsNoneIsRefusedAndOneThatBreaksLaterChangesNothing) {
  const std::string path = TokenFile(options_.store).path();
  WriteFile(path, "no tokens\n");
  EXPECT_EQ(RefusedStart().reason(), "INVALID_FILE");
  std::filesystem::remove(path);
  const std::string token = NewToken(Role::kViewer, "");
  StartServer();
  WriteFile(path, ReadFile(path) + "no token\n");
  std::this_thread::sleep_for(2 * TokenBook::kLookEvery);  // it is looked at, and nothing follows
  EXPECT_TRUE(ConnectAs(token).ListMaps().ok());
  // Else the operator would believe it to be revoked.
  EXPECT_FALSE(TokenFile(options_.store).Revoke(ParseToken(token)->id).ok());
}

// A writer that died in the middle of a line.
TEST_F(TokenTest, ALineThatWasNotWrittenWholeCountsAsNotThere) {
  const std::string path = TokenFile(options_.store).path();
  const std::string first = NewToken(Role::kViewer, "");
  WriteFile(path, ReadFile(path) + R"({"event": "crea)");
  const std::string second = NewToken(Role::kViewer, "");
  StartServer();
  EXPECT_TRUE(ConnectAs(first).ListMaps().ok());
  EXPECT_TRUE(ConnectAs(second).ListMaps().ok());
}

}  // namespace
}  // namespace maploc::testing
