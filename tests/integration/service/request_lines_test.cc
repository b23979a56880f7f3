// The log of a real server: its requests, one JSON object a line.
#include <sstream>

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "maploc/v1/localization_service.grpc.pb.h"
#include "mapstore/store/sqlite_store.h"
#include "proto/convert/convert.h"
#include "tests/support/files.h"
#include "tests/support/seed.h"
#include "tests/support/server_process.h"
#include "tests/support/stored_world.h"

namespace maploc::testing {
namespace {

using Json = nlohmann::json;

constexpr char kTrace[] = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";

class RequestLinesTest : public ::testing::Test {
 protected:
  RequestLinesTest() {
    const auto store = OpenSqliteStore(folder_.File("store")).value();
    ImportWorld(world_, store.get());
    stub_ = v1::LocalizationService::NewStub(
        grpc::CreateChannel(server_.Start(), grpc::InsecureChannelCredentials()));
  }

  std::string StartSession() const {
    v1::StartSessionRequest request;
    request.set_map("street");
    request.set_robot("rover");
    v1::StartSessionResponse response;
    grpc::ClientContext context;
    EXPECT_TRUE(stub_->StartSession(&context, request, &response).ok());
    return response.session_id();
  }
  grpc::Status Localize(const std::string& session, const std::string& request_id) const {
    Random random = TestRandom(1);
    Query query = world_.See(DrawnWorld::CameraFromMapAt(5.0, 0.2), QueryNoise(), random);
    query.session = session;
    query.map.clear();
    query.request_id = request_id;
    v1::LocalizeRequest request;
    QueryToProto(query, false, &request);
    v1::LocalizeResponse response;
    grpc::ClientContext context;
    context.AddMetadata("traceparent", kTrace);
    return stub_->Localize(&context, request, &response);
  }
  // Stops the server; its lines about requests of this method.
  std::vector<Json> Lines(const std::string& method) {
    server_.Stop();
    std::vector<Json> found;
    std::istringstream log(folder_.Read("stderr"));
    for (std::string text; std::getline(log, text);) {
      const Json line = Json::parse(text, nullptr, /*allow_exceptions=*/false);
      EXPECT_TRUE(line.is_object() && line.contains("time") && line.contains("level")) << text;
      if (line.value("message", "") == "request" && line.value("method", "") == method) {
        found.push_back(line);
      }
    }
    return found;
  }

  const TemporaryFolder folder_;
  const DrawnWorld world_{TestRandom()};
  ServerProcess server_{
      folder_, {"--log-format", "json", "--log-requests", "1", "--slow-query-ms", "0.001"}};
  std::unique_ptr<v1::LocalizationService::Stub> stub_;
};

TEST_F(RequestLinesTest, TellWhoAskedAndWhatBecameOfIt) {
  const std::string session = StartSession();
  ASSERT_TRUE(Localize(session, "photo 7").ok());
  ASSERT_FALSE(Localize("no such session", "photo 8").ok());

  const std::vector<Json> lines = Lines("Localize");
  ASSERT_EQ(lines.size(), 2u);
  const Json& good = lines[0];
  EXPECT_EQ(good["code"], "OK");
  EXPECT_EQ(good["outcome"], "LOCALIZED");
  EXPECT_EQ(good["request_id"], "photo 7");
  EXPECT_EQ(good["traceparent"], kTrace);
  EXPECT_EQ(good["robot"], "rover");
  EXPECT_EQ(good["map"], "street");
  EXPECT_EQ(good["version"], 1);
  EXPECT_EQ(good["session"], session);
  EXPECT_GT(good["matching_ms"], 0.0);
  EXPECT_GT(good["ms"], good["matching_ms"]);
  const Json& refused = lines[1];
  EXPECT_EQ(refused["level"], "warning");
  EXPECT_EQ(refused["code"], "NOT_FOUND");
  EXPECT_EQ(refused["reason"], "SESSION_NOT_FOUND");
  EXPECT_EQ(refused["request_id"], "photo 8");
}

TEST_F(RequestLinesTest, ANameThatIsRefusedIsNotInThem) {
  ASSERT_FALSE(Localize("session\n{\"forged\": true}", "photo").ok());
  const std::vector<Json> lines = Lines("Localize");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["reason"], "CONTROL_CHARACTER");
  EXPECT_FALSE(lines[0].contains("session"));
}

}  // namespace
}  // namespace maploc::testing
