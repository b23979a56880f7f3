#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include "proto/convert/convert.h"
#include "tests/unit/proto/convert/valid_request.h"

namespace maploc {
namespace {

using google::protobuf::util::MessageDifferencer;

TEST(QueryFromProto, ReadsEveryField) {
  const Result<Query> query = QueryFromProto(testing::ValidRequest());

  ASSERT_TRUE(query.ok()) << query.status().ToString();
  EXPECT_EQ(query->session, "0123456789abcdef");
  EXPECT_EQ(query->map, "yard");
  EXPECT_EQ(query->request_id, "frame-17");
  EXPECT_EQ(query->map_version, 3);
  EXPECT_EQ(query->capture_unix_ns, 1'700'000'000'000'000'000);
  EXPECT_EQ(query->requested_strategy, Strategy::k2P);
  EXPECT_EQ(query->refinement, Refinement::k4Dof);
  EXPECT_EQ(query->max_error_px, 6.5);
  ASSERT_TRUE(query->gravity.has_value());
  EXPECT_EQ(query->gravity->direction_in_body, Eigen::Vector3d(0, 1, 0));  // normalized
  EXPECT_EQ(query->gravity->sigma_rad, 0.01);
  ASSERT_TRUE(query->prior.has_value());
  EXPECT_EQ(query->prior->position_in_map, Eigen::Vector3d(3, 0, 0));
  EXPECT_EQ(query->prior->sigma_m, 2);
}

TEST(QueryFromProto, ReadsTheView) {
  const Result<Query> query = QueryFromProto(testing::ValidRequest());

  ASSERT_TRUE(query.ok()) << query.status().ToString();
  ASSERT_EQ(query->views.size(), 1u);
  const View& view = query->views[0];
  EXPECT_EQ(view.camera.model(), CameraModel::kOpenCv);
  EXPECT_EQ(view.camera.width_px(), 640);
  EXPECT_EQ(view.camera.height_px(), 480);
  EXPECT_EQ(view.camera.params()[1], 501.0);
  EXPECT_NEAR(view.camera_from_body.rotation.x(), 0.6, 1e-15);
  EXPECT_NEAR(view.camera_from_body.rotation.w(), 0.8, 1e-15);
  EXPECT_EQ(view.camera_from_body.translation.z(), 0.25);
  ASSERT_EQ(view.points.keypoints_px.size(), 3u);
  EXPECT_EQ(view.points.keypoints_px[1], Eigen::Vector2f(3.5f, 4.25f));
  EXPECT_EQ(view.points.descriptors.size(), 3);
  EXPECT_EQ(view.points.descriptors.kind.name, "orb");
  ASSERT_EQ(view.lines.size(), 2);
  EXPECT_EQ(view.lines.starts_px[1], Eigen::Vector2f(50, 60));
  EXPECT_EQ(view.lines.ends_px[1], Eigen::Vector2f(70, 80));
  EXPECT_EQ(view.lines.descriptors.kind.name, "lbd");
}

TEST(QueryFromProto, TheBodyIsTheCameraWhereNoTransformIsGiven) {
  v1::LocalizeRequest request = testing::ValidRequest();
  request.mutable_views(0)->clear_camera_from_body();
  const Result<Query> query = QueryFromProto(request);
  ASSERT_TRUE(query.ok());
  EXPECT_EQ(query->views[0].camera_from_body.rotation.w(), 1.0);
  EXPECT_EQ(query->views[0].camera_from_body.translation, Eigen::Vector3d::Zero());
}

TEST(QueryFromProto, FeaturesMayBeAbsent) {
  v1::LocalizeRequest request = testing::ValidRequest();
  request.mutable_views(0)->clear_points();
  request.mutable_views(0)->clear_lines();
  const Result<Query> query = QueryFromProto(request);
  ASSERT_TRUE(query.ok()) << query.status().ToString();
  EXPECT_EQ(query->views[0].points.descriptors.size(), 0);
  EXPECT_EQ(query->views[0].lines.size(), 0);
}

TEST(QueryToProto, ComesBackTheSame) {
  v1::LocalizeRequest request = testing::ValidRequest();
  request.mutable_gravity()->mutable_direction_in_body()->set_y(1);
  const Result<Query> query = QueryFromProto(request);
  ASSERT_TRUE(query.ok());

  v1::LocalizeRequest again;
  QueryToProto(*query, /*include_matches=*/true, &again);

  MessageDifferencer differ;
  std::string differences;
  differ.set_float_comparison(MessageDifferencer::APPROXIMATE);
  differ.ReportDifferencesToString(&differences);
  EXPECT_TRUE(differ.Compare(request, again)) << differences;
}

TEST(QueryToProto, AbsentStaysAbsent) {
  v1::LocalizeRequest request = testing::ValidRequest();
  request.clear_prior();
  request.clear_strategy();
  const Result<Query> query = QueryFromProto(request);
  ASSERT_TRUE(query.ok());

  v1::LocalizeRequest again;
  QueryToProto(*query, false, &again);

  EXPECT_FALSE(again.has_prior());
  EXPECT_EQ(again.strategy(), v1::STRATEGY_UNSPECIFIED);
  EXPECT_FALSE(again.include_matches());
}

}  // namespace
}  // namespace maploc
