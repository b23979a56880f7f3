// Answers, summaries and maps: there and back, and what a client must not believe.
#include <limits>

#include <gtest/gtest.h>

#include "maploc/v1/localization_service.pb.h"
#include "maploc/v1/map_service.pb.h"
#include "proto/convert/convert.h"

namespace maploc {
namespace {

Localization LocalizedAnswer() {
  Localization answer;
  answer.outcome = Outcome::kLocalized;
  answer.map = {"yard", 3};
  answer.segment = 2;
  answer.map_from_body = Rigid3{Eigen::Quaterniond(0.8, 0, 0.6, 0), Eigen::Vector3d(1, 2, 3)};
  answer.covariance = PoseCovariance::Identity();
  answer.covariance(0, 5) = 0.25;
  answer.evidence.points = {10, 8};
  answer.evidence.usable_lines = {5, 3};
  answer.evidence.vertical_lines = {4, 2};
  answer.evidence.strategy = Strategy::k1P1L;
  answer.evidence.fell_back = true;
  answer.evidence.iterations = 77;
  answer.evidence.gravity_disagreement_rad = 0.01;
  answer.evidence.gravity_rejected = true;
  answer.evidence.confidence = 0.999;
  answer.evidence.inlier_rms_px = 0.75;
  answer.evidence.focal_scale = FocalScale{1.02, 0.003};
  answer.strategy_source = StrategySource::kPinned;
  answer.predicted_success = 0.125;
  answer.times = {1, 2, 3, 4, 5, 16};
  answer.matches.points = {{.feature = 4}, {.feature = 9}};
  answer.point_match_inlier = {1, 0};
  answer.matches.lines = {{.feature = 1}};
  answer.line_match_inlier = {1};
  return answer;
}

v1::LocalizeResponse LocalizedResponse() {
  v1::LocalizeResponse response;
  LocalizationToProto(Query{}, LocalizedAnswer(), true, &response);
  return response;
}

TEST(LocalizationConvert, ComesBackTheSame) {
  const Localization sent = LocalizedAnswer();
  const Result<Localization> got = LocalizationFromProto(LocalizedResponse(), "yard");

  ASSERT_TRUE(got.ok()) << got.status().ToString();
  EXPECT_EQ(got->outcome, sent.outcome);
  EXPECT_EQ(got->map, sent.map);
  EXPECT_EQ(got->segment, sent.segment);
  EXPECT_EQ(got->map_from_body->translation, sent.map_from_body->translation);
  EXPECT_NEAR(got->map_from_body->rotation.y(), 0.6, 1e-15);
  EXPECT_EQ(got->covariance, sent.covariance);
  EXPECT_EQ(got->evidence.points, sent.evidence.points);
  EXPECT_EQ(got->evidence.usable_lines, sent.evidence.usable_lines);
  EXPECT_EQ(got->evidence.vertical_lines, sent.evidence.vertical_lines);
  EXPECT_EQ(got->evidence.strategy, sent.evidence.strategy);
  EXPECT_EQ(got->evidence.fell_back, sent.evidence.fell_back);
  EXPECT_EQ(got->evidence.iterations, sent.evidence.iterations);
  EXPECT_EQ(got->evidence.gravity_disagreement_rad, sent.evidence.gravity_disagreement_rad);
  EXPECT_EQ(got->evidence.gravity_rejected, sent.evidence.gravity_rejected);
  EXPECT_EQ(got->evidence.confidence, sent.evidence.confidence);
  EXPECT_EQ(got->evidence.inlier_rms_px, sent.evidence.inlier_rms_px);
  EXPECT_EQ(got->evidence.focal_scale, sent.evidence.focal_scale);
  EXPECT_EQ(got->strategy_source, sent.strategy_source);
  EXPECT_EQ(got->predicted_success, sent.predicted_success);
  EXPECT_EQ(got->times.retrieval_ms, 2);
  EXPECT_EQ(got->times.total_ms, 16);
  ASSERT_EQ(got->matches.points.size(), 2u);
  EXPECT_EQ(got->matches.points[1].feature, 9);
  EXPECT_EQ(got->point_match_inlier, sent.point_match_inlier);
  EXPECT_EQ(got->matches.lines[0].feature, 1);
  EXPECT_EQ(got->line_match_inlier, sent.line_match_inlier);
}

TEST(LocalizationConvert, EchoesTheQueryAndHoldsMatchesOnlyWhenAsked) {
  Query query;
  query.request_id = "frame-1";
  query.capture_unix_ns = 42;
  v1::LocalizeResponse response;
  LocalizationToProto(query, LocalizedAnswer(), false, &response);
  EXPECT_EQ(response.request_id(), "frame-1");
  EXPECT_EQ(response.capture_unix_nanos(), 42);
  EXPECT_FALSE(response.has_point_matches());
  EXPECT_FALSE(response.has_line_matches());
}

TEST(LocalizationConvert, NotLocalizedHasNoPose) {
  Localization answer;
  answer.outcome = Outcome::kTooFewMatches;
  answer.segment = 1;
  v1::LocalizeResponse response;
  LocalizationToProto(Query{}, answer, true, &response);
  EXPECT_FALSE(response.has_map_from_body());
  EXPECT_EQ(response.covariance_size(), 0);

  const Result<Localization> got = LocalizationFromProto(response, "yard");
  ASSERT_TRUE(got.ok()) << got.status().ToString();
  EXPECT_EQ(got->outcome, Outcome::kTooFewMatches);
  EXPECT_FALSE(got->map_from_body.has_value());
}

TEST(LocalizationConvert, ACalibrationThatMatchesContradictHasNoPose) {
  Localization answer;
  answer.outcome = Outcome::kCalibrationInconsistent;
  v1::LocalizeResponse response;
  LocalizationToProto(Query{}, answer, true, &response);
  EXPECT_FALSE(response.has_focal_length_scale()) << "not determined";

  const Result<Localization> got = LocalizationFromProto(response, "yard");
  ASSERT_TRUE(got.ok()) << got.status().ToString();
  EXPECT_EQ(got->outcome, Outcome::kCalibrationInconsistent);
  EXPECT_FALSE(got->evidence.focal_scale.has_value());
}

TEST(LocalizationConvert, MatchesWithoutVerdictAgreeWithNothing) {
  Localization answer;
  answer.outcome = Outcome::kNoConsensus;
  answer.matches.points = {{.feature = 3}};
  v1::LocalizeResponse response;
  LocalizationToProto(Query{}, answer, true, &response);
  EXPECT_EQ(response.point_matches().inliers(), std::string(1, '\0'));
}

void ExpectRefused(const v1::LocalizeResponse& response, const std::string& field) {
  const Result<Localization> got = LocalizationFromProto(response, "yard");
  ASSERT_FALSE(got.ok());
  EXPECT_EQ(got.status().message().rfind(field + ": ", 0), 0u) << got.status().message();
}

TEST(LocalizationConvert, RefusesAnAnswerThatContradictsItself) {
  v1::LocalizeResponse response = LocalizedResponse();
  response.clear_map_from_body();
  ExpectRefused(response, "map_from_body");

  response = LocalizedResponse();
  response.set_outcome(v1::OUTCOME_NO_CONSENSUS);
  ExpectRefused(response, "map_from_body");

  response = LocalizedResponse();
  response.mutable_covariance()->RemoveLast();
  ExpectRefused(response, "covariance");

  response = LocalizedResponse();
  response.clear_outcome();
  ExpectRefused(response, "outcome");

  response = LocalizedResponse();
  response.mutable_point_matches()->clear_inliers();
  ExpectRefused(response, "point_matches.inliers");
}

TEST(LocalizationConvert, RefusesEvidenceThatMakesNoSense) {
  v1::LocalizeResponse response = LocalizedResponse();
  response.set_outcome(static_cast<v1::Outcome>(8));
  ExpectRefused(response, "outcome");

  response = LocalizedResponse();
  response.set_inlier_rms_pixels(-1);
  ExpectRefused(response, "inlier_rms_pixels");

  response = LocalizedResponse();
  response.set_inlier_rms_pixels(std::numeric_limits<double>::quiet_NaN());
  ExpectRefused(response, "inlier_rms_pixels");

  response = LocalizedResponse();
  response.set_confidence(std::numeric_limits<double>::quiet_NaN());
  ExpectRefused(response, "confidence");

  response = LocalizedResponse();
  response.mutable_times()->set_total_ms(std::numeric_limits<double>::infinity());
  ExpectRefused(response, "times.total_ms");

  response = LocalizedResponse();
  response.mutable_points()->set_match_count(-1);
  ExpectRefused(response, "points");

  response = LocalizedResponse();
  response.mutable_vertical_lines()->set_inlier_count(5);  // of 4 matches
  ExpectRefused(response, "vertical_lines");

  response = LocalizedResponse();
  response.set_iteration_count(-1);
  ExpectRefused(response, "iteration_count");

  response = LocalizedResponse();
  response.set_covariance(7, -1e-9);  // a negative variance of y, whose root is no number
  ExpectRefused(response, "covariance[7]");

  response = LocalizedResponse();
  response.set_focal_length_scale(0);
  ExpectRefused(response, "focal_length_scale");

  response = LocalizedResponse();
  response.set_focal_length_scale_sigma(-0.1);
  ExpectRefused(response, "focal_length_scale_sigma");

  response = LocalizedResponse();
  response.clear_focal_length_scale_sigma();
  ExpectRefused(response, "focal_length_scale_sigma");
}

TEST(SessionConvert, SummaryComesBackTheSame) {
  SessionSummary summary;
  summary.session = "abc";
  summary.end = SessionEnd::kIdle;
  summary.queries = 7;
  summary.localized = 5;
  summary.segments = {{0, 3, 2, Strategy::kMixed, Strategy::k1P1L},
                      {4, 4, 3, Strategy::k2P, Strategy::k2P}};
  v1::EndSessionResponse response;
  SessionSummaryToProto(summary, &response);
  const Result<SessionSummary> got = SessionSummaryFromProto(response, "abc");
  ASSERT_TRUE(got.ok()) << got.status().ToString();
  EXPECT_EQ(*got, summary);
}

v1::StartSessionRequest ValidStart() {
  v1::StartSessionRequest request;
  request.set_map("yard");
  request.set_robot("rover-1");
  request.set_request_id("start-1");
  request.set_map_version(3);
  (*request.mutable_labels())["season"] = "autumn";
  return request;
}

TEST(SessionConvert, StartIsRead) {
  const Result<SessionRequest> got = SessionRequestFromProto(ValidStart());
  ASSERT_TRUE(got.ok()) << got.status().ToString();
  EXPECT_EQ(got->map, "yard");
  EXPECT_EQ(got->robot, "rover-1");
  EXPECT_EQ(got->request_id, "start-1");
  EXPECT_EQ(got->map_version, 3);
  EXPECT_EQ(got->labels.at("season"), "autumn");
}

void ExpectStartRefused(const v1::StartSessionRequest& request, const std::string& field) {
  const Result<SessionRequest> got = SessionRequestFromProto(request);
  ASSERT_FALSE(got.ok());
  EXPECT_EQ(got.status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(got.status().message().rfind(field, 0), 0u) << got.status().message();
}

TEST(SessionConvert, StartIsRefusedWithTheField) {
  v1::StartSessionRequest request = ValidStart();
  request.clear_map();
  ExpectStartRefused(request, "map: ");

  request = ValidStart();
  request.clear_robot();
  ExpectStartRefused(request, "robot: ");

  request = ValidStart();
  request.set_request_id(std::string(129, 'r'));
  ExpectStartRefused(request, "request_id: ");

  request = ValidStart();
  (*request.mutable_labels())["light"] = std::string(129, 'v');
  ExpectStartRefused(request, "labels[light]: ");

  request = ValidStart();
  (*request.mutable_labels())["a]: forged: b"] = std::string(129, 'v');
  ExpectStartRefused(request, "labels: is 129 bytes long");

  request = ValidStart();
  (*request.mutable_labels())[""] = "autumn";
  ExpectStartRefused(request, "labels: one has an empty key");
  request = ValidStart();
  request.set_map_version(-1);
  ExpectStartRefused(request, "map_version: ");

  request = ValidStart();
  for (int i = 0; i < kMaxLabels; ++i) request.mutable_labels()->insert({std::to_string(i), {}});
  ExpectStartRefused(request, "labels: ");

  ASSERT_FALSE(SessionIdFromProto(v1::EndSessionRequest()).ok());
}

TEST(MapConvert, InfoComesBackTheSame) {
  MapInfo info;
  info.key = {"yard", 4};
  info.metric = true;
  info.map_from_source.scale = 2.5;
  info.map_from_source.translation = {1, 2, 3};
  info.point_descriptor = *DescriptorKindFromName("sift_root_u8");
  v1::Map proto;
  MapInfoToProto(info, &proto);
  const Result<MapInfo> got = MapInfoFromProto(proto);
  ASSERT_TRUE(got.ok()) << got.status().ToString();
  EXPECT_EQ(got->key, info.key);
  EXPECT_TRUE(got->metric);
  EXPECT_EQ(got->map_from_source.scale, 2.5);
  EXPECT_EQ(got->map_from_source.translation, info.map_from_source.translation);
  EXPECT_EQ(got->point_descriptor, info.point_descriptor);
  EXPECT_EQ(got->line_descriptor, DescriptorKind{});  // a map without lines

  proto.mutable_map_from_source()->set_scale(0);
  EXPECT_FALSE(MapInfoFromProto(proto).ok());
}

TEST(MapConvert, RatiosAreUnsetBeforeEvidence) {
  v1::Segment proto;
  SegmentKnowledgeToProto({}, {}, &proto);
  EXPECT_FALSE(proto.has_point_inlier_ratio());
  EXPECT_FALSE(proto.has_line_inlier_ratio());
  EXPECT_EQ(proto.strategy(), v1::STRATEGY_MIXED);
  EXPECT_EQ(proto.strategy_source(), v1::STRATEGY_SOURCE_DEFAULT);

  SegmentStatistics statistics;
  statistics.point_matches = 100;
  statistics.point_inliers = 40;
  SegmentKnowledgeToProto(statistics, {}, &proto);
  EXPECT_DOUBLE_EQ(proto.point_inlier_ratio(), 0.4);
  EXPECT_FALSE(proto.has_line_inlier_ratio());
}

}  // namespace
}  // namespace maploc
