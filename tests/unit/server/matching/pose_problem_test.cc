#include "server/matching/pose_problem.h"

#include <gmock/gmock.h>

#include "mapstore/geometry/pixel_scale.h"
#include "server/matching/segment_matching.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

const DescriptorKind kOrb{"orb", 32, DescriptorMetric::kHamming};
const DescriptorKind kLbd{"lbd", 32, DescriptorMetric::kHamming};

Descriptors RandomDescriptors(const DescriptorKind& kind, int count, Random& random) {
  Descriptors result{kind, {}};
  for (int i = 0; i < count * kind.bytes; ++i) {
    result.bytes.push_back(static_cast<std::uint8_t>(random.Below(256)));
  }
  return result;
}

// A fisheye camera, whose distortion cannot be overlooked.
Camera Fisheye() {
  return Camera::Create(CameraModel::kOpenCvFisheye, 640, 480,
                        {300, 310, 320, 240, -0.02, 0.01, -0.003, 0.0})
      .value();
}

Camera Pinhole() {
  return Camera::Create(CameraModel::kPinhole, 640, 480, {300, 310, 320, 240}).value();
}

// A segment of points and lines before the camera at the map's origin, and the view that it gives:
// feature i is landmark (count - 1 - i).
struct Scene {
  explicit Scene(Random random, const Camera& camera = Fisheye()) : view{camera, {}, {}, {}} {
    view.camera_from_body.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized());
    for (int i = 0; i < kCount; ++i) {
      segment.points.ids.push_back(i);
      segment.points.positions_in_map.push_back(RandomPoint(random));
      segment.points.descriptor_landmark.push_back(i);
      segment.lines.ids.push_back(i);
      segment.lines.segments_in_map.push_back({RandomPoint(random), RandomPoint(random)});
      segment.lines.descriptor_landmark.push_back(i);
    }
    segment.points.descriptors = RandomDescriptors(kOrb, kCount, random);
    segment.lines.descriptors = RandomDescriptors(kLbd, kCount, random);
    view.points.descriptors.kind = kOrb;
    view.lines.descriptors.kind = kLbd;
    for (int i = kCount - 1; i >= 0; --i) See(i);
  }

  static constexpr int kCount = 20;
  static Eigen::Vector3d RandomPoint(Random& random) {
    return {random.Uniform(-3, 3), random.Uniform(-2, 2), random.Uniform(3, 6)};
  }

  void See(int i) {
    const auto project = [&](const Eigen::Vector3d& point) {
      return Eigen::Vector2f(view.camera.Project(point)->cast<float>());
    };
    const auto copy = [i](const Descriptors& from, Descriptors& to) {
      to.bytes.insert(to.bytes.end(), from.row(i).begin(), from.row(i).end());
    };
    view.points.keypoints_px.push_back(project(segment.points.positions_in_map[i]));
    view.lines.starts_px.push_back(project(segment.lines.segments_in_map[i].start));
    view.lines.ends_px.push_back(project(segment.lines.segments_in_map[i].end));
    copy(segment.points.descriptors, view.points.descriptors);
    copy(segment.lines.descriptors, view.lines.descriptors);
  }

  View view;
  Segment segment;
};

TEST(MatchSegmentTest, FindsThePointsAndLinesThatAreSeen) {
  const Scene scene(testing::TestRandom());
  const Matches matches = MatchSegment(scene.view, scene.segment);
  ASSERT_EQ(matches.points.size(), 20u);
  ASSERT_EQ(matches.lines.size(), 20u);
  for (int i = 0; i < Scene::kCount; ++i) {
    EXPECT_EQ(matches.points[i].feature, i);
    EXPECT_EQ(matches.points[i].landmark, Scene::kCount - 1 - i);
    EXPECT_EQ(matches.lines[i].landmark, Scene::kCount - 1 - i);
  }
}

TEST(MatchSegmentTest, LinesOfAnotherKindAndMissingLinesMatchNothing) {
  Scene scene(testing::TestRandom());
  scene.segment.lines.descriptors.kind = {"binary32", 32, DescriptorMetric::kHamming};
  EXPECT_TRUE(MatchSegment(scene.view, scene.segment).lines.empty());
  scene.segment.lines = {};
  EXPECT_TRUE(MatchSegment(scene.view, scene.segment).lines.empty());
  EXPECT_EQ(MatchSegment(scene.view, scene.segment).points.size(), 20u);
}

TEST(BuildPoseProblemTest, UndistortsFeaturesIntoThePlaneAtDistanceOne) {
  const Scene scene(testing::TestRandom(), Pinhole());
  const Matches matches = MatchSegment(scene.view, scene.segment);
  const MatchedProblem built = BuildPoseProblem(matches, scene.view, scene.segment, std::nullopt);
  ASSERT_EQ(built.problem.points.size(), 20u);
  for (const PointCorrespondence& point : built.problem.points) {
    EXPECT_FALSE(point.frame.has_value());
    EXPECT_LT((point.normalized - point.position_in_map.hnormalized()).norm(), 1e-6);
  }
  for (const LineCorrespondence& line : built.problem.lines) {
    EXPECT_LT((line.normalized.start - line.segment_in_map.start.hnormalized()).norm(), 1e-6);
    EXPECT_LT((line.normalized.end - line.segment_in_map.end.hnormalized()).norm(), 1e-6);
  }
  EXPECT_DOUBLE_EQ(built.problem.focal_length_px, std::sqrt(300.0 * 310.0));
  EXPECT_FALSE(built.problem.has_gravity);
}

TEST(BuildPoseProblemTest, TellsFromWhereLandmarksWereSeen) {
  Scene scene(testing::TestRandom());
  const Matches matches{{{2, 5, 0.5f}}, {{3, 7, 0.5f}}};
  const PoseProblem unknown =
      BuildPoseProblem(matches, scene.view, scene.segment, std::nullopt).problem;
  EXPECT_FALSE(unknown.points[0].viewing.IsKnown());
  EXPECT_FALSE(unknown.lines[0].viewing.IsKnown());

  scene.segment.points.viewing.resize(Scene::kCount);
  scene.segment.points.viewing[5] = {{0, 0, 1}, 0.25f, 1, 2};
  scene.segment.lines.viewing.resize(Scene::kCount);
  scene.segment.lines.viewing[7] = {{0, 1, 0}, 0.5f, 3, 4};
  const PoseProblem known =
      BuildPoseProblem(matches, scene.view, scene.segment, std::nullopt).problem;
  EXPECT_EQ(known.points[0].viewing, scene.segment.points.viewing[5]);
  EXPECT_EQ(known.lines[0].viewing, scene.segment.lines.viewing[7]);
}

TEST(BuildPoseProblemTest, GivesWideCamerasFramesInPixelsOfTheirImage) {
  const Scene scene(testing::TestRandom());
  const Matches matches = MatchSegment(scene.view, scene.segment);
  const PoseProblem problem =
      BuildPoseProblem(matches, scene.view, scene.segment, std::nullopt).problem;
  ASSERT_EQ(problem.points.size(), 20u);
  const double focal = problem.focal_length_px;
  EXPECT_DOUBLE_EQ(focal, std::sqrt(300.0 * 310.0));
  const Camera camera = Fisheye();
  for (const PointCorrespondence& point : problem.points) {
    const Eigen::Vector2d pixel = *camera.Project(point.position_in_map);
    EXPECT_LT((focal * point.normalized + camera.principal_point_px() - pixel).norm(), 1e-4);
    ASSERT_TRUE(point.frame.has_value());
    EXPECT_LT((point.frame->ray - point.position_in_map.normalized()).norm(), 1e-6);
    EXPECT_LT((focal * point.frame->across - camera.Frame(pixel)->across).norm(), 1e-2);
  }
  for (const LineCorrespondence& line : problem.lines) {
    ASSERT_TRUE(line.frames.has_value());
    EXPECT_LT(((*line.frames)[0].ray - line.segment_in_map.start.normalized()).norm(), 1e-6);
    EXPECT_LT(((*line.frames)[1].ray - line.segment_in_map.end.normalized()).norm(), 1e-6);
  }
}

// 8 pixels of 4K, where a radian has as many more: a pixel and a half of VGA's.
TEST(BuildPoseProblemTest, SaysPixelsOfAVgaSizedImage) {
  const Camera camera =
      Camera::Create(CameraModel::kPinhole, 3840, 2160, {3000, 3000, 1920, 1080}).value();
  const Scene scene(testing::TestRandom(), camera);
  const PoseProblem problem = BuildPoseProblem({}, scene.view, scene.segment, std::nullopt).problem;
  EXPECT_NEAR(problem.focal_length_px, 3000 / (std::hypot(3840, 2160) / 800), 1e-9);
  EXPECT_NEAR(PixelScale(camera), std::hypot(3840, 2160) / 800, 1e-9);
}

// Six pixels off are three of VGA's, in a lens of twice as many a radian.
TEST(BuildPoseProblemTest, SaysPixelsOfAVgaSizedImageToWideCamerasToo) {
  const Camera camera = Camera::Create(CameraModel::kOpenCvFisheye, 3840, 2160,
                                       {1000, 1000, 1920, 1080, 0.0, 0.0, 0.0, 0.0})
                            .value();
  ASSERT_TRUE(camera.IsWide());
  ASSERT_DOUBLE_EQ(PixelScale(camera), 2.0);
  Scene scene(testing::TestRandom(), camera);
  for (Eigen::Vector2f& keypoint_px : scene.view.points.keypoints_px) keypoint_px.x() += 6.0f;
  const Matches matches = MatchSegment(scene.view, scene.segment);
  const PoseProblem problem =
      BuildPoseProblem(matches, scene.view, scene.segment, std::nullopt).problem;
  ASSERT_EQ(problem.points.size(), 20u);
  for (const PointCorrespondence& point : problem.points) {
    const Eigen::Vector3d& landmark = point.position_in_map;
    const Eigen::Vector2d error = point.frame->across * landmark / point.frame->ray.dot(landmark);
    EXPECT_NEAR(problem.focal_length_px * error.norm(), 3.0, 0.1);
  }
}

TEST(BuildPoseProblemTest, TurnsGravityFromTheBodyIntoTheCamera) {
  const Scene scene(testing::TestRandom());
  const Gravity gravity{Eigen::Vector3d(0.6, 0.0, -0.8), 0.02};
  const PoseProblem problem = BuildPoseProblem({}, scene.view, scene.segment, gravity).problem;
  EXPECT_TRUE(problem.has_gravity);
  EXPECT_DOUBLE_EQ(problem.gravity_sigma_rad, 0.02);
  const Eigen::Vector3d want = scene.view.camera_from_body.rotation * gravity.direction_in_body;
  EXPECT_LT((problem.gravity_in_camera - want).norm(), 1e-12);
}

TEST(BuildPoseProblemTest, DropsWhatTheCameraCannotHaveSeenFromMatchesAndProblemAlike) {
  Scene scene(testing::TestRandom());
  scene.view.points.keypoints_px[3] = {50000.0f, 240.0f};
  scene.view.lines.ends_px[5] = {50000.0f, 240.0f};
  Matches matches;
  for (int i = 0; i < Scene::kCount; ++i) {
    matches.points.push_back({i, i, 0.5f});
    matches.lines.push_back({i, i, 0.25f});
  }
  const MatchedProblem built = BuildPoseProblem(matches, scene.view, scene.segment, std::nullopt);
  ASSERT_EQ(built.problem.points.size(), 19u);
  ASSERT_EQ(built.matches.points.size(), 19u);
  ASSERT_EQ(built.problem.lines.size(), 19u);
  ASSERT_EQ(built.matches.lines.size(), 19u);
  EXPECT_EQ(built.matches.points[3].feature, 4);
  EXPECT_EQ(built.matches.lines[5].feature, 6);
  EXPECT_EQ(built.problem.points[3].position_in_map, scene.segment.points.positions_in_map[4]);
  EXPECT_EQ(built.problem.points[3].ratio, 0.5);
  EXPECT_EQ(built.problem.lines[5].ratio, 0.25);
}

}  // namespace
}  // namespace maploc
