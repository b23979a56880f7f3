// Every kind of bad request: the right code, the field or thing it is about, and a server that goes
// on serving with an unchanged store.
#include <filesystem>
#include <functional>
#include <limits>

#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>

#include "maploc/v1/localization_service.grpc.pb.h"
#include "proto/convert/convert.h"
#include "tests/integration/service/service_fixture.h"

namespace maploc::testing {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct BadRequest {
  std::string name;
  std::function<void(v1::LocalizeRequest*)> spoil;
  grpc::StatusCode code;
  std::string message_start;
  std::string reason;
};

const std::vector<BadRequest>& BadRequests() {
  using R = v1::LocalizeRequest;
  constexpr auto kInvalid = grpc::StatusCode::INVALID_ARGUMENT;
  static const std::vector<BadRequest> requests = {
      {"NanKeypoint",
       [](R* r) { r->mutable_views(0)->mutable_points()->set_coordinates_pixels(7, kNan); },
       kInvalid, "views[0].points.coordinates_pixels[7]: ", "NOT_FINITE"},
      {"WrongBlobLength",
       [](R* r) { r->mutable_views(0)->mutable_points()->mutable_descriptors()->pop_back(); },
       kInvalid, "views[0].points.descriptors: ", "DESCRIPTOR_LENGTH"},
      {"WrongLineBlobLength",
       [](R* r) { r->mutable_views(0)->mutable_lines()->mutable_descriptors()->push_back('x'); },
       kInvalid, "views[0].lines.descriptors: ", "DESCRIPTOR_LENGTH"},
      {"ZeroGravity", [](R* r) { r->mutable_gravity()->mutable_direction_in_body()->Clear(); },
       kInvalid, "gravity.direction_in_body: ", "ZERO_GRAVITY"},
      {"ZeroFocalLength", [](R* r) { r->mutable_views(0)->mutable_camera()->set_params(0, 0.0); },
       kInvalid, "views[0].camera.params[0]: ", "BAD_FOCAL_LENGTH"},
      {"UnknownMap", [](R* r) { r->set_map("nowhere"); }, grpc::StatusCode::NOT_FOUND,
       "map 'nowhere'", "MAP_NOT_FOUND"},
      {"UnknownSession", [](R* r) { r->set_session_id("nobody"); }, grpc::StatusCode::NOT_FOUND,
       "session 'nobody'", "SESSION_NOT_FOUND"},
      {"OtherDescriptorKind",
       [](R* r) {
         r->mutable_views(0)->mutable_points()->mutable_descriptor_kind()->set_name("binary32");
       },
       grpc::StatusCode::FAILED_PRECONDITION, "", "DESCRIPTOR_KIND_MISMATCH"},
      {"TwoViews", [](R* r) { *r->add_views() = r->views(0); }, kInvalid,
       "views: ", "TOO_MANY_VIEWS"},
  };
  return requests;
}

std::string Reason(const grpc::ClientContext& context) {
  const auto& trailer = context.GetServerTrailingMetadata();
  const auto reason = trailer.find("maploc-reason");
  return reason == trailer.end() ? "" : std::string(reason->second.begin(), reason->second.end());
}

class BadInputTest : public ServiceTest {
 protected:
  grpc::Status Send(const v1::LocalizeRequest& request, grpc::ClientContext* context) {
    const auto stub = v1::LocalizationService::NewStub(
        grpc::CreateChannel(Address(), grpc::InsecureChannelCredentials()));
    context->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(30));
    v1::LocalizeResponse response;
    return stub->Localize(context, request, &response);
  }
};

TEST_F(BadInputTest, IsRefusedWithTheFieldAndChangesNothing) {
  const SessionId session = StartSession();
  const std::int64_t counter = store_->ChangeCounter().value();
  for (const BadRequest& bad : BadRequests()) {
    SCOPED_TRACE(bad.name);
    v1::LocalizeRequest request;
    QueryToProto(QueryAt(2.0, bad.name == "UnknownMap" ? "" : session), false, &request);
    bad.spoil(&request);
    grpc::ClientContext context;
    const grpc::Status status = Send(request, &context);
    EXPECT_EQ(status.error_code(), bad.code);
    EXPECT_EQ(status.error_message().rfind(bad.message_start, 0), 0u) << status.error_message();
    EXPECT_NE(status.error_message().find(bad.reason), std::string::npos);
    EXPECT_EQ(Reason(context), bad.reason);
    EXPECT_TRUE(client_->Localize(QueryAt(2.0)).ok()) << "the server no longer serves";
  }
  EXPECT_EQ(store_->ChangeCounter().value(), counter);
  EXPECT_TRUE(store_->Verify().ok());
  EXPECT_EQ(client_->EndSession(session)->queries, 0);  // errors do not count
}

TEST_F(BadInputTest, SessionsRefuseWhatIsNotTheirs) {
  const SessionId session = StartSession();
  Query query = QueryAt(2.0, session);
  query.map = "garden";
  EXPECT_EQ(client_->Localize(query).status().reason(), "MAP_MISMATCH");
  query.map = "";  // the session's
  EXPECT_TRUE(client_->Localize(query).ok());
  ASSERT_TRUE(client_->EndSession(session).ok());
  EXPECT_EQ(client_->Localize(query).status().code(), StatusCode::kFailedPrecondition);
  EXPECT_EQ(client_->Localize(query).status().reason(), "SESSION_CLOSED");
  EXPECT_EQ(client_->EndSession("nobody").status().code(), StatusCode::kNotFound);
  EXPECT_EQ(client_->StartSession("garden", "rover", {}).status().reason(), "MAP_NOT_FOUND");
  EXPECT_EQ(client_->StartSession("street", "", {}).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(client_->GetSegment("street", 99).status().reason(), "SEGMENT_NOT_FOUND");
  EXPECT_EQ(client_->GetMap("").status().code(), StatusCode::kInvalidArgument);
}

// Bytes as they come, through no stub of ours.
grpc::Status SendBytes(const std::string& address, const std::string& method,
                       const std::string& bytes, grpc::ClientContext* context) {
  const grpc::Slice slice(bytes);
  const grpc::ByteBuffer request(&slice, 1);
  grpc::ByteBuffer response;
  grpc::GenericStub stub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
  grpc::CompletionQueue queue;
  const auto call = stub.PrepareUnaryCall(context, method, request, &queue);
  call->StartCall();
  grpc::Status status;
  call->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  return status;
}

TEST_F(BadInputTest, BytesThatAreNoMessageAreRefusedInWords) {
  // Field 2 of StartSession is the robot: "Zürich" in Latin-1.
  const std::string latin1 = "\x0a\x06street\x12\x06Z\xfcrich";
  for (const std::string& bytes : {latin1, std::string("\xff\xff\xff"), std::string("\x0a\x7f")}) {
    grpc::ClientContext context;
    const grpc::Status status =
        SendBytes(Address(), "/maploc.v1.LocalizationService/StartSession", bytes, &context);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(Reason(context), "NOT_PARSED");
    EXPECT_NE(status.error_message().find("StartSessionRequest"), std::string::npos);
    EXPECT_NE(status.error_message().find("UTF-8"), std::string::npos);
  }
}

TEST_F(BadInputTest, KindsThatDifferInMoreThanTheirNameAreToldWhole) {
  Query query = QueryAt(2.0);
  query.views[0].points.descriptors.kind.bytes = 16;
  query.views[0].points.descriptors.bytes.resize(16 * query.views[0].points.keypoints_px.size());
  const std::string message = client_->Localize(query).status().message();
  EXPECT_NE(message.find("16 bytes"), std::string::npos) << message;
  EXPECT_NE(message.find("32 bytes"), std::string::npos) << message;
}

TEST_F(BadInputTest, RobotsAreNotToldWhereTheStoreLies) {
  ASSERT_TRUE(client_->Localize(QueryAt(2.0)).ok());
  std::filesystem::rename(folder_.File("store"), folder_.File("elsewhere"));
  const Status status = client_->Localize(QueryAt(2.0)).status();
  EXPECT_EQ(status.reason(), "STORE_REPLACED");
  EXPECT_EQ(status.message().find(folder_.File("")), std::string::npos) << status.message();
  std::filesystem::rename(folder_.File("elsewhere"), folder_.File("store"));
}

TEST_F(BadInputTest, TheLargestQueryIsTaken) {
  Query query = QueryAt(2.0);
  View& view = query.views[0];
  while (static_cast<int>(view.points.keypoints_px.size()) < kMaxFeatures) {
    view.points.keypoints_px.push_back(view.points.keypoints_px.front());
    view.points.descriptors.bytes.resize(view.points.descriptors.bytes.size() + 32);
  }
  const Result<Localization> answer = client_->Localize(query);
  ASSERT_TRUE(answer.ok()) << answer.status().ToString();
  view.points.keypoints_px.push_back(view.points.keypoints_px.front());
  view.points.descriptors.bytes.resize(view.points.descriptors.bytes.size() + 32);
  EXPECT_EQ(client_->Localize(query).status().reason(), "TOO_MANY_FEATURES");
}

}  // namespace
}  // namespace maploc::testing
