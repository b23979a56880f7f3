// Every malformed request is refused with the path of the field that is wrong.
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "proto/convert/convert.h"
#include "tests/unit/proto/convert/valid_request.h"

namespace maploc {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Refusal {
  std::string name;
  std::function<void(v1::LocalizeRequest*)> spoil;
  std::string field;  // the message begins with it
  std::string reason;
  StatusCode code = StatusCode::kInvalidArgument;
};

v1::Features* Points(v1::LocalizeRequest* r) { return r->mutable_views(0)->mutable_points(); }
v1::Features* Lines(v1::LocalizeRequest* r) { return r->mutable_views(0)->mutable_lines(); }
v1::Camera* CameraOf(v1::LocalizeRequest* r) { return r->mutable_views(0)->mutable_camera(); }
v1::Rigid3* CameraFromBody(v1::LocalizeRequest* r) {
  return r->mutable_views(0)->mutable_camera_from_body();
}
v1::Vector3* GravityVector(v1::LocalizeRequest* r) {
  return r->mutable_gravity()->mutable_direction_in_body();
}
void FillFeatures(int count, v1::Features* features) {
  for (int i = features->coordinates_pixels_size(); i < 2 * count; ++i) {
    features->add_coordinates_pixels(1);
  }
  features->set_descriptors(std::string(32ul * count, 'x'));
}

// Rows as the definition of sift_root_u8 has them, but scaled to `length`.
void FillSift(double length, v1::Features* features) {
  const int count = features->coordinates_pixels_size() / 2;
  // A quarter of the 128 numbers is 0, the others are equal.
  const auto value = static_cast<char>(std::lround(length / std::sqrt(96.0)));
  std::string row(128, '\0');
  for (int i = 0; i < 128; ++i) row[i] = i % 4 == 0 ? '\0' : value;
  features->clear_descriptors();
  for (int i = 0; i < count; ++i) features->mutable_descriptors()->append(row);
  features->mutable_descriptor_kind()->set_name("sift_root_u8");
  features->mutable_descriptor_kind()->set_bytes_count(128);
  features->mutable_descriptor_kind()->set_metric(v1::DESCRIPTOR_METRIC_L2_U8);
}

const std::vector<Refusal>& Refusals() {
  using R = v1::LocalizeRequest;
  static const std::vector<Refusal> refusals = {
      {"MaxErrorZero", [](R* r) { r->set_max_error_pixels(0); }, "max_error_pixels",
       "OUT_OF_RANGE"},
      {"MaxErrorNan", [](R* r) { r->set_max_error_pixels(kNan); }, "max_error_pixels",
       "OUT_OF_RANGE"},
      {"KeypointNan", [](R* r) { Points(r)->set_coordinates_pixels(3, kNan); },
       "views[0].points.coordinates_pixels[3]", "NOT_FINITE"},
      {"KeypointInfinite", [](R* r) { Points(r)->set_coordinates_pixels(5, -kInfinity); },
       "views[0].points.coordinates_pixels[5]", "NOT_FINITE"},
      {"KeypointFarAway", [](R* r) { Points(r)->set_coordinates_pixels(0, 1e30f); },
       "views[0].points.coordinates_pixels[0]", "OUT_OF_RANGE"},
      {"OddCoordinates", [](R* r) { Points(r)->add_coordinates_pixels(1); },
       "views[0].points.coordinates_pixels", "COUNT_MISMATCH"},
      {"PointBlobShort", [](R* r) { Points(r)->mutable_descriptors()->pop_back(); },
       "views[0].points.descriptors", "DESCRIPTOR_LENGTH"},
      {"PointBlobLong", [](R* r) { Points(r)->mutable_descriptors()->push_back('x'); },
       "views[0].points.descriptors", "DESCRIPTOR_LENGTH"},
      {"BlobWithoutPoints", [](R* r) { Points(r)->clear_coordinates_pixels(); },
       "views[0].points.descriptors", "DESCRIPTOR_LENGTH"},
      {"PointKindAbsent", [](R* r) { Points(r)->clear_descriptor_kind(); },
       "views[0].points.descriptor_kind", "REQUIRED"},
      {"KindBytesZero", [](R* r) { Points(r)->mutable_descriptor_kind()->set_bytes_count(0); },
       "views[0].points.descriptor_kind.bytes_count", "OUT_OF_RANGE"},
      {"KindBytesHuge",
       [](R* r) { Points(r)->mutable_descriptor_kind()->set_bytes_count(0x7fffffff); },
       "views[0].points.descriptor_kind.bytes_count", "OUT_OF_RANGE"},
      {"KindMetricUnknown",
       [](R* r) {
         Points(r)->mutable_descriptor_kind()->set_metric(static_cast<v1::DescriptorMetric>(9));
       },
       "views[0].points.descriptor_kind.metric", "UNKNOWN_ENUM_VALUE"},
      {"KindNameEmpty", [](R* r) { Lines(r)->mutable_descriptor_kind()->clear_name(); },
       "views[0].lines.descriptor_kind.name", "REQUIRED"},
      {"TooManyPoints", [](R* r) { FillFeatures(kMaxFeatures + 1, Points(r)); },
       "views[0].points.coordinates_pixels", "TOO_MANY_FEATURES", StatusCode::kResourceExhausted},
      {"LineNan", [](R* r) { Lines(r)->set_coordinates_pixels(6, kNan); },
       "views[0].lines.coordinates_pixels[6]", "NOT_FINITE"},
      {"LineOfThreeNumbers", [](R* r) { Lines(r)->mutable_coordinates_pixels()->RemoveLast(); },
       "views[0].lines.coordinates_pixels", "COUNT_MISMATCH"},
      {"LineWithoutLength",
       [](R* r) {
         Lines(r)->set_coordinates_pixels(6, 50);
         Lines(r)->set_coordinates_pixels(7, 60);
       },
       "views[0].lines.coordinates_pixels[4]", "DEGENERATE_LINE"},
      {"LineBlobShort", [](R* r) { Lines(r)->mutable_descriptors()->resize(32); },
       "views[0].lines.descriptors", "DESCRIPTOR_LENGTH"},
      {"NoView", [](R* r) { r->clear_views(); }, "views", "REQUIRED"},
      {"TwoViews", [](R* r) { *r->add_views() = r->views(0); }, "views", "TOO_MANY_VIEWS"},
      {"NoCamera", [](R* r) { r->mutable_views(0)->clear_camera(); }, "views[0].camera",
       "REQUIRED"},
      {"CameraModelUnset", [](R* r) { CameraOf(r)->set_model(v1::CAMERA_MODEL_UNSPECIFIED); },
       "views[0].camera.model", "UNKNOWN_ENUM_VALUE"},
      {"CameraModelUnknown", [](R* r) { CameraOf(r)->set_model(static_cast<v1::CameraModel>(77)); },
       "views[0].camera.model", "UNKNOWN_ENUM_VALUE"},
      {"ZeroWidth", [](R* r) { CameraOf(r)->set_width_pixels(0); }, "views[0].camera.width_pixels",
       "OUT_OF_RANGE"},
      {"HugeHeight", [](R* r) { CameraOf(r)->set_height_pixels(65537); },
       "views[0].camera.height_pixels", "OUT_OF_RANGE"},
      {"ParamMissing", [](R* r) { CameraOf(r)->mutable_params()->RemoveLast(); },
       "views[0].camera.params", "COUNT_MISMATCH"},
      {"ZeroFocalLength", [](R* r) { CameraOf(r)->set_params(0, 0.0); },
       "views[0].camera.params[0]", "BAD_FOCAL_LENGTH"},
      {"NegativeSecondFocalLength", [](R* r) { CameraOf(r)->set_params(1, -500.0); },
       "views[0].camera.params[1]", "BAD_FOCAL_LENGTH"},
      {"DistortionNan", [](R* r) { CameraOf(r)->set_params(4, kNan); }, "views[0].camera.params[4]",
       "NOT_FINITE"},
      {"PrincipalPointFarAway", [](R* r) { CameraOf(r)->set_params(2, 1e9); },
       "views[0].camera.params[2]", "OUT_OF_RANGE"},
      {"RotationNotUnit", [](R* r) { CameraFromBody(r)->mutable_rotation()->set_w(1.0); },
       "views[0].camera_from_body.rotation", "NOT_UNIT_QUATERNION"},
      {"RotationUnset", [](R* r) { CameraFromBody(r)->clear_rotation(); },
       "views[0].camera_from_body.rotation", "NOT_UNIT_QUATERNION"},
      {"RotationNan", [](R* r) { CameraFromBody(r)->mutable_rotation()->set_z(kNan); },
       "views[0].camera_from_body.rotation", "NOT_FINITE"},
      {"TranslationInfinite",
       [](R* r) { CameraFromBody(r)->mutable_translation()->set_x(kInfinity); },
       "views[0].camera_from_body.translation", "NOT_FINITE"},
      {"GravityZero", [](R* r) { GravityVector(r)->set_y(0); }, "gravity.direction_in_body",
       "ZERO_GRAVITY"},
      {"GravityUnsetVector", [](R* r) { r->mutable_gravity()->clear_direction_in_body(); },
       "gravity.direction_in_body", "ZERO_GRAVITY"},
      {"GravityNan", [](R* r) { GravityVector(r)->set_x(kNan); }, "gravity.direction_in_body",
       "NOT_FINITE"},
      {"SigmaUnset", [](R* r) { r->mutable_gravity()->clear_sigma_radians(); },
       "gravity.sigma_radians", "OUT_OF_RANGE"},
      {"SigmaNegative", [](R* r) { r->mutable_gravity()->set_sigma_radians(-0.01); },
       "gravity.sigma_radians", "OUT_OF_RANGE"},
      {"SigmaInDegrees", [](R* r) { r->mutable_gravity()->set_sigma_radians(2.0); },
       "gravity.sigma_radians", "OUT_OF_RANGE"},
      {"SigmaNan", [](R* r) { r->mutable_gravity()->set_sigma_radians(kNan); },
       "gravity.sigma_radians", "OUT_OF_RANGE"},
      {"PriorNan", [](R* r) { r->mutable_prior()->mutable_position_in_map()->set_z(kNan); },
       "prior.position_in_map", "NOT_FINITE"},
      {"PriorFarAway", [](R* r) { r->mutable_prior()->mutable_position_in_map()->set_z(1e300); },
       "prior.position_in_map", "OUT_OF_RANGE"},
      {"PriorWithoutPosition", [](R* r) { r->mutable_prior()->clear_position_in_map(); },
       "prior.position_in_map", "REQUIRED"},
      {"BodyWithoutTranslation", [](R* r) { CameraFromBody(r)->clear_translation(); },
       "views[0].camera_from_body.translation", "REQUIRED"},
      {"PriorSigmaZero", [](R* r) { r->mutable_prior()->set_position_sigma(0); },
       "prior.position_sigma", "OUT_OF_RANGE"},
      {"PriorSigmaInfinite", [](R* r) { r->mutable_prior()->set_position_sigma(kInfinity); },
       "prior.position_sigma", "OUT_OF_RANGE"},
      {"StrategyUnknown", [](R* r) { r->set_strategy(static_cast<v1::Strategy>(5)); }, "strategy",
       "UNKNOWN_ENUM_VALUE"},
      {"RefinementUnknown", [](R* r) { r->set_refinement(static_cast<v1::RefinementMode>(-1)); },
       "refinement", "UNKNOWN_ENUM_VALUE"},
      {"SessionIdTooLong", [](R* r) { r->set_session_id(std::string(129, 'a')); }, "session_id",
       "TOO_LONG"},
      {"MapTooLong", [](R* r) { r->set_map(std::string(129, 'a')); }, "map", "TOO_LONG"},
      {"NegativeMapVersion", [](R* r) { r->set_map_version(-1); }, "map_version", "OUT_OF_RANGE"},
      {"RequestIdTooLong", [](R* r) { r->set_request_id(std::string(129, 'a')); }, "request_id",
       "TOO_LONG"},
      {"MapTurnedAround", [](R* r) { r->set_map("\u202edray"); }, "map", "CONTROL_CHARACTER"},
      {"SiftScaledTo255", [](R* r) { FillSift(255.0, Points(r)); }, "views[0].points.descriptors",
       "DESCRIPTOR_SCALE"},
      {"SiftScaledToOne", [](R* r) { FillSift(1.0, Points(r)); }, "views[0].points.descriptors",
       "DESCRIPTOR_SCALE"},
      {"MapWithNewline", [](R* r) { r->set_map("ya\nrd"); }, "map", "CONTROL_CHARACTER"},
      {"MapNotUtf8", [](R* r) { r->set_map("Stra\xDF"); }, "map", "NOT_UTF8"},
      {"NeitherMapNorSession",
       [](R* r) {
         r->clear_map();
         r->clear_session_id();
       },
       "map", "REQUIRED"},
      {"CaptureBeforeEpoch", [](R* r) { r->set_capture_unix_nanos(-1); }, "capture_unix_nanos",
       "OUT_OF_RANGE"},
  };
  return refusals;
}

class QueryRefusal : public ::testing::TestWithParam<Refusal> {};

TEST_P(QueryRefusal, NamesTheField) {
  v1::LocalizeRequest request = testing::ValidRequest();
  ASSERT_TRUE(QueryFromProto(request).ok());
  GetParam().spoil(&request);

  const Result<Query> query = QueryFromProto(request);

  ASSERT_FALSE(query.ok());
  EXPECT_EQ(query.status().code(), GetParam().code);
  EXPECT_EQ(query.status().reason(), GetParam().reason);
  EXPECT_EQ(query.status().message().rfind(GetParam().field + ": ", 0), 0u)
      << query.status().message();
}

INSTANTIATE_TEST_SUITE_P(All, QueryRefusal, ::testing::ValuesIn(Refusals()),
                         [](const auto& test) { return test.param.name; });

TEST(QueryLimits, TheLargestRequestIsTaken) {
  v1::LocalizeRequest request = testing::ValidRequest();
  FillFeatures(kMaxFeatures, Points(&request));
  const Result<Query> query = QueryFromProto(request);
  ASSERT_TRUE(query.ok()) << query.status().ToString();
  EXPECT_EQ(query->views[0].points.descriptors.size(), kMaxFeatures);
}

TEST(SiftRows, OfTheirLengthAreTaken) {
  v1::LocalizeRequest request = testing::ValidRequest();
  FillSift(512.0, Points(&request));
  EXPECT_TRUE(QueryFromProto(request).ok()) << QueryFromProto(request).status().ToString();
}

}  // namespace
}  // namespace maploc
