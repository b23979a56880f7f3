#include "mapstore/importers/shared_error.h"

#include <cmath>

#include <gtest/gtest.h>

#include "mapstore/base/random.h"
#include "tests/support/seed.h"

namespace maploc {
namespace {

constexpr double kFocalPx = 500.0;

// Frames in a row before a cloud of points, each of which all of them see; every frame's pose is
// written down with a turn about its y axis by N(0, `turn_rad`), its keypoints with N(0, 0.5 px).
ColmapModel MakeModel(int frames, double turn_rad, Random& random) {
  ColmapModel model;
  const Camera camera =
      Camera::Create(CameraModel::kSimplePinhole, 640, 480, {kFocalPx, 319.5, 239.5}).value();
  model.cameras.emplace(1, camera);
  for (int i = 0; i < 60; ++i) {
    ColmapPoint point;
    point.id = i;
    point.position_in_source = {random.Uniform(-2, 2), random.Uniform(-1.5, 1.5),
                                random.Uniform(5, 8)};
    model.points[i] = point;
  }
  for (int f = 0; f < frames; ++f) {
    ColmapImage image;
    image.id = f;
    image.camera_id = 1;
    const Rigid3 truth = {Eigen::Quaterniond::Identity(), {0.1 * f, 0, 0}};
    const Eigen::AngleAxisd turn(random.Gaussian(turn_rad), Eigen::Vector3d::UnitY());
    image.camera_from_source = Rigid3{Eigen::Quaterniond(turn), {0, 0, 0}} * truth;
    for (auto& [id, point] : model.points) {
      const Eigen::Vector2d noise(random.Gaussian(0.5), random.Gaussian(0.5));
      image.keypoints_px.push_back(*camera.Project(truth * point.position_in_source) + noise);
      image.point_ids.push_back(id);
      point.track.push_back({f, static_cast<std::int32_t>(image.point_ids.size() - 1)});
    }
    model.images[f] = image;
  }
  return model;
}

// The landmarks here are true, so that a frame hides nothing; the share that is given back makes it
// look m / (m - 1) times as large. Both as the definition has it.
TEST(SharedErrorRad, IsWhatTheMeanOfTheFramesErrorsIs) {
  Random random = testing::TestRandom();
  constexpr double kTurnRad = 0.004;
  constexpr int kFrames = 30;
  const double told = SharedErrorRad(MakeModel(kFrames, kTurnRad, random));
  // A turn about y moves the image along x alone, by a little more than the angle off the axis.
  const double expected =
      kTurnRad / std::sqrt(2.0) * kFrames / (kFrames - 1.0) / std::sqrt(kFrames);
  EXPECT_GT(told, 0.6 * expected);
  EXPECT_LT(told, 1.5 * expected);
}

TEST(SharedErrorRad, IsNextToNothingWhereFramesAgree) {
  Random random = testing::TestRandom();
  EXPECT_LT(SharedErrorRad(MakeModel(10, 0.0, random)), 0.2 / kFocalPx / std::sqrt(10));
}

TEST(SharedErrorRad, IsNotKnownWithoutObservations) { EXPECT_EQ(SharedErrorRad({}), 0.0); }

}  // namespace
}  // namespace maploc
