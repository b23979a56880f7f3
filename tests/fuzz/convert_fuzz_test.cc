// Mutated and random bytes through the parsers at the door: whatever comes, they answer, and what
// they let through keeps the invariants that nobody checks again. A plain loop, so that it runs
// wherever the tests run; MAPLOC_FUZZ_SECONDS makes it longer, MAPLOC_TEST_SEED different.
#include <cmath>

#include <google/protobuf/stubs/logging.h>
#include <gtest/gtest.h>

#include "maploc/v1/localization_service.pb.h"
#include "proto/convert/convert.h"
#include "tests/fuzz/mutate.h"
#include "tests/support/seed.h"
#include "tests/unit/proto/convert/valid_request.h"

namespace maploc {
namespace {

void ExpectSound(const Query& query) {
  ASSERT_EQ(query.views.size(), 1u);
  const View& view = query.views[0];
  ASSERT_EQ(view.points.descriptors.size(), static_cast<int>(view.points.keypoints_px.size()));
  ASSERT_EQ(view.lines.descriptors.size(), view.lines.size());
  ASSERT_EQ(view.lines.starts_px.size(), view.lines.ends_px.size());
  for (const Eigen::Vector2f& keypoint_px : view.points.keypoints_px) {
    ASSERT_TRUE(keypoint_px.allFinite());
  }
  for (int i = 0; i < view.lines.size(); ++i) {
    ASSERT_NE(view.lines.starts_px[i], view.lines.ends_px[i]);
  }
  if (query.gravity) {
    ASSERT_NEAR(query.gravity->direction_in_body.norm(), 1.0, 1e-9);
  }
  ASSERT_NEAR(view.camera_from_body.rotation.norm(), 1.0, 1e-9);
  ASSERT_GE(view.camera.MeanFocalLengthPx(), 0.1);
}

// Protobuf reports invalid UTF-8 on standard error; here that is the daily bread.
class ConvertFuzz : public ::testing::Test {
  google::protobuf::LogSilencer silence_;
};

TEST_F(ConvertFuzz, QueryFromProtoSurvivesAnything) {
  Random random = testing::TestRandom();
  const std::string valid = testing::ValidRequest().SerializeAsString();
  const auto end = std::chrono::steady_clock::now() + testing::FuzzTime();
  int accepted = 0;
  int refused = 0;
  while (std::chrono::steady_clock::now() < end) {
    v1::LocalizeRequest request;
    if (!request.ParseFromString(testing::NextInput(random, valid))) continue;
    const Result<Query> query = QueryFromProto(request);
    if (query.ok()) {
      ++accepted;
      ExpectSound(*query);
    } else {
      ++refused;
      ASSERT_NE(query.status().message().find(": "), std::string::npos);
    }
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(accepted, 100) << "the mutations never reach past the checks";
  EXPECT_GT(refused, 100) << "the mutations never break anything";
}

TEST_F(ConvertFuzz, AnswersAndSessionsSurviveAnything) {
  Random random = testing::TestRandom();
  v1::LocalizeResponse valid;
  Localization localized;
  localized.outcome = Outcome::kLocalized;
  localized.map_from_body = Rigid3{};
  localized.covariance = PoseCovariance::Identity();
  localized.matches.points = {{.feature = 1}, {.feature = 2}};
  LocalizationToProto(Query{}, localized, true, &valid);
  const std::string bytes = valid.SerializeAsString();
  const auto end = std::chrono::steady_clock::now() + testing::FuzzTime();
  int accepted = 0;
  while (std::chrono::steady_clock::now() < end) {
    const std::string input = testing::NextInput(random, bytes);
    v1::LocalizeResponse response;
    if (response.ParseFromString(input)) {
      const Result<Localization> answer = LocalizationFromProto(response, "yard");
      accepted += answer.ok() ? 1 : 0;
      if (answer.ok()) {
        ASSERT_EQ(answer->matches.points.size(), answer->point_match_inlier.size());
      }
    }
    v1::StartSessionRequest start;
    if (start.ParseFromString(input)) (void)SessionRequestFromProto(start);
    v1::EndSessionResponse summary;
    if (summary.ParseFromString(input)) (void)SessionSummaryFromProto(summary, "id");
  }
  EXPECT_GT(accepted, 100);
}

}  // namespace
}  // namespace maploc
