#include "mapstore/geometry/camera.h"

#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/seed.h"

namespace maploc {
namespace {

using ::testing::HasSubstr;

struct Case {
  CameraModel model;
  std::string name;
  std::vector<double> params;
};

// The frame's errors against the projection's own, by central differences; and its two sides.
void ExpectFirstOrder(const Camera& camera, const Eigen::Vector2d& pixel) {
  const auto frame = camera.Frame(pixel);
  ASSERT_TRUE(frame.has_value()) << pixel.transpose();
  EXPECT_LT((frame->across * frame->ray).norm(), 1e-9 * frame->across.norm());
  constexpr double kStep = 1e-6;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector2d by_axis =
        (*camera.Project(frame->ray + step) - *camera.Project(frame->ray - step)) / (2 * kStep);
    EXPECT_LT((frame->across.col(axis) - by_axis).norm(), 1e-6 * frame->across.norm());
  }
  const Eigen::Matrix2d one = frame->across * frame->Gradient().transpose();
  EXPECT_LT((one - Eigen::Matrix2d::Identity()).norm(), 1e-9);
  // An area of the sphere becomes its image's.
  const Eigen::Vector3d normal = frame->across.row(0).transpose().cross(frame->across.row(1));
  EXPECT_NEAR(frame->Scale() * frame->Scale(), normal.norm(), 1e-9 * normal.norm());
}

class CameraModelTest : public ::testing::TestWithParam<Case> {};

TEST_P(CameraModelTest, NormalizeUndoesProjectOverTheWholeImage) {
  const Camera camera = Camera::Create(GetParam().model, 752, 480, GetParam().params).value();
  for (int x = 0; x < 752; x += 47) {
    for (int y = 0; y < 480; y += 40) {
      const Eigen::Vector2d pixel(x, y);
      const auto normalized = camera.Normalize(pixel);
      ASSERT_TRUE(normalized.has_value()) << pixel.transpose();
      const auto projected = camera.Project(3.0 * normalized->homogeneous());
      ASSERT_TRUE(projected.has_value());
      EXPECT_LT((*projected - pixel).norm(), 1e-9) << pixel.transpose();
    }
  }
}

TEST_P(CameraModelTest, RayUndoesProjectAndAgreesWithNormalize) {
  const Camera camera = Camera::Create(GetParam().model, 752, 480, GetParam().params).value();
  for (int x = 0; x < 752; x += 47) {
    for (int y = 0; y < 480; y += 40) {
      const Eigen::Vector2d pixel(x, y);
      const auto ray = camera.Ray(pixel);
      ASSERT_TRUE(ray.has_value()) << pixel.transpose();
      EXPECT_NEAR(ray->norm(), 1.0, 1e-14);
      EXPECT_LT((*camera.Project(3.0 * *ray) - pixel).norm(), 1e-9) << pixel.transpose();
      EXPECT_LT((ray->hnormalized() - *camera.Normalize(pixel)).norm(), 1e-9);
    }
  }
}

TEST_P(CameraModelTest, FrameTellsPixelErrorsToFirstOrder) {
  const Camera camera = Camera::Create(GetParam().model, 752, 480, GetParam().params).value();
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(376, 240), Eigen::Vector2d(10, 20), Eigen::Vector2d(700, 100)}) {
    ExpectFirstOrder(camera, pixel);
  }
}

TEST_P(CameraModelTest, HasColmapsNameAndCountOfParameters) {
  const CameraModel model = GetParam().model;
  EXPECT_EQ(CameraModelName(model), GetParam().name);
  EXPECT_EQ(CameraParamCount(model), static_cast<int>(GetParam().params.size()));
}

TEST_P(CameraModelTest, RefusesAWrongCountZeroFocalLengthAndNaN) {
  const auto create = [](std::vector<double> params) {
    return Camera::Create(GetParam().model, 640, 480, std::move(params), "views[0].camera")
        .status();
  };
  std::vector<double> params = GetParam().params;
  params[0] = 0.0;
  EXPECT_THAT(create(params).message(), HasSubstr("views[0].camera.params[0]"));
  params = GetParam().params;
  params.back() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(create(params).message(), HasSubstr("must be finite"));
  params.pop_back();
  EXPECT_THAT(create(params).message(), HasSubstr("parameters, got"));
}

INSTANTIATE_TEST_SUITE_P(
    Models, CameraModelTest,
    ::testing::Values(Case{CameraModel::kSimplePinhole, "SIMPLE_PINHOLE", {500, 376, 240}},
                      Case{CameraModel::kPinhole, "PINHOLE", {500, 510, 376, 240}},
                      Case{CameraModel::kSimpleRadial, "SIMPLE_RADIAL", {500, 376, 240, -0.1}},
                      Case{CameraModel::kRadial, "RADIAL", {500, 376, 240, -0.1, 0.02}},
                      Case{CameraModel::kOpenCv,
                           "OPENCV",
                           {458.65, 457.3, 367.2, 248.4, -0.2834, 0.074, 0.00019, 1.8e-5}},
                      Case{CameraModel::kOpenCvFisheye,
                           "OPENCV_FISHEYE",
                           {380, 380, 376, 240, -0.01, 0.02, -0.01, 0.002}}));

// Independent arithmetic, written out for one point: x/z = 0.5, y/z = -0.25, r2 = 0.3125.
TEST(CameraTest, ProjectsOpenCvModelAsDocumented) {
  const Camera camera =
      Camera::Create(CameraModel::kOpenCv, 640, 480, {400, 410, 320, 240, 0.1, 0.01, 0.001, 0.002})
          .value();
  const double radial = 1 + 0.1 * 0.3125 + 0.01 * 0.3125 * 0.3125;
  const double x = 0.5 * radial + 2 * 0.001 * (0.5 * -0.25) + 0.002 * (0.3125 + 2 * 0.25);
  const double y = -0.25 * radial + 0.001 * (0.3125 + 2 * 0.0625) + 2 * 0.002 * (0.5 * -0.25);
  const auto pixel = camera.Project(Eigen::Vector3d(1.0, -0.5, 2.0));
  ASSERT_TRUE(pixel.has_value());
  EXPECT_NEAR(pixel->x(), 400 * x + 320, 1e-9);
  EXPECT_NEAR(pixel->y(), 410 * y + 240, 1e-9);
}

TEST(CameraTest, HasNoPixelForWhatIsBehind) {
  const Camera camera = Camera::Create(CameraModel::kSimplePinhole, 10, 10, {5, 5, 5}).value();
  EXPECT_FALSE(camera.Project(Eigen::Vector3d(0, 0, 0)).has_value());
  EXPECT_FALSE(camera.Project(Eigen::Vector3d(1, 1, -1)).has_value());
}

// With strong barrel distortion no ray reaches the far corner: saying so is right, a made-up ray
// would be wrong.
TEST(CameraTest, RefusesPixelsThatNoRayReaches) {
  const Camera camera =
      Camera::Create(CameraModel::kSimpleRadial, 2000, 2000, {300, 1000, 1000, -0.4}).value();
  EXPECT_FALSE(camera.Normalize({0, 0}).has_value());
  EXPECT_TRUE(camera.Normalize({950, 1020}).has_value());
}

// A plane serves a pinhole at any angle and a common lens, not one that squeezes its rim.
TEST(CameraTest, IsWideWhereThePlanesPixelsAreNone) {
  const auto is_wide = [](CameraModel model, std::vector<double> params) {
    return Camera::Create(model, 752, 480, std::move(params)).value().IsWide();
  };
  EXPECT_FALSE(is_wide(CameraModel::kPinhole, {100, 100, 376, 240}));
  EXPECT_FALSE(is_wide(CameraModel::kOpenCv,
                       {458.65, 457.3, 367.2, 248.4, -0.2834, 0.074, 0.00019, 1.8e-5}));
  EXPECT_TRUE(is_wide(CameraModel::kOpenCv, {300, 300, 376, 240, -0.2, 0.02, 0, 0}));
  EXPECT_TRUE(is_wide(CameraModel::kOpenCvFisheye, {300, 300, 376, 240, 0, 0, 0, 0}));
}

// A lens of 220 degrees, equidistant but for a little: 90 degrees are no limit.
TEST(CameraTest, FisheyeSeesBehindItsPlane) {
  const Camera camera = Camera::Create(CameraModel::kOpenCvFisheye, 800, 800,
                                       {200, 200, 400, 400, 0.004, -0.003, 0.0005, -0.00003})
                            .value();
  const double degree = std::acos(-1.0) / 180.0;
  for (double theta = 1; theta < 110; theta += 4) {
    for (double turn = 0; turn < 360; turn += 33) {
      const Eigen::Vector3d ray(std::sin(theta * degree) * std::cos(turn * degree),
                                std::sin(theta * degree) * std::sin(turn * degree),
                                std::cos(theta * degree));
      const auto pixel = camera.Project(7.0 * ray);
      ASSERT_TRUE(pixel.has_value()) << theta;
      EXPECT_LT((*camera.Ray(*pixel) - ray).norm(), 1e-12) << theta;
      EXPECT_EQ(camera.Normalize(*pixel).has_value(), theta < 89.4);
      ExpectFirstOrder(camera, *pixel);
    }
  }
  ExpectFirstOrder(camera, {400, 400});
}

// k1 = -0.2 alone folds at sqrt(1 / 0.6) = 74 degrees.
TEST(CameraTest, FisheyeEndsWhereItsPolynomialFolds) {
  const Camera camera =
      Camera::Create(CameraModel::kOpenCvFisheye, 800, 800, {200, 200, 400, 400, -0.2, 0, 0, 0})
          .value();
  const auto looking = [](double theta) {
    return Eigen::Vector3d(std::sin(theta), 0, std::cos(theta));
  };
  const double fold = std::sqrt(1 / 0.6);
  EXPECT_TRUE(camera.Project(looking(fold - 1e-3)).has_value());
  EXPECT_FALSE(camera.Project(looking(fold + 1e-3)).has_value());
  const double edge = 200 * fold * (1 - 0.2 * fold * fold);
  EXPECT_TRUE(camera.Ray({400 + edge - 0.1, 400}).has_value());
  EXPECT_FALSE(camera.Ray({400 + edge + 0.1, 400}).has_value());
}

}  // namespace
}  // namespace maploc
