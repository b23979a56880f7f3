#include "mapstore/importers/landmark_views.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "mapstore/importers/point_geometry.h"
#include "tests/support/seed.h"
#include "tests/support/seen_through.h"
#include "tests/unit/mapstore/importers/drawn_scene.h"

namespace maploc {
namespace {

Eigen::Matrix3d Unpack(const PositionCovariance& packed) {
  Eigen::Matrix3d covariance;
  covariance << packed[0], packed[1], packed[2], packed[1], packed[3], packed[4], packed[2],
      packed[4], packed[5];
  return covariance;
}

// The point as TriangulatePoint places it, over many draws of the noise.
Eigen::Matrix3d SampledCovariance(const Eigen::Vector3d& point, std::span<const KeyFrame> frames,
                                  double noise_px, int draws, Random& random) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int draw = 0; draw < draws; ++draw) {
    std::vector<PointObservation> views;
    for (const KeyFrame& frame : frames) {
      const double focal_length_px = frame.camera.MeanFocalLengthPx();
      const Eigen::Vector2d noise(random.Gaussian(noise_px), random.Gaussian(noise_px));
      views.push_back({frame.camera_from_map,
                       (frame.camera_from_map * point).hnormalized() + noise / focal_length_px,
                       focal_length_px});
    }
    const Eigen::Vector3d error = *TriangulatePoint(views) - point;
    sum += error * error.transpose();
  }
  return sum / draws;
}

TEST(CovarianceFromFramesTest, IsWhatTriangulationMakesOfNoise) {
  constexpr double kNoisePx = 0.1;  // small, so that the error is linear in it
  Random random = testing::TestRandom();
  const std::vector<KeyFrame> frames = {testing::MakeFrame(0, {-2, -8, 1}),
                                        testing::MakeFrame(1, {0.5, -9, 2}),
                                        testing::MakeFrame(2, {1.5, -7, 0})};
  const std::vector<std::int32_t> seen_by = {0, 1, 2};
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 3, 2)}) {
    const Eigen::Matrix3d told = Unpack(CovarianceFromFrames(point, frames, seen_by));
    const Eigen::Matrix3d sampled =
        SampledCovariance(point, frames, kNoisePx, 4000, random) / (kNoisePx * kNoisePx);
    EXPECT_LT((told - sampled).norm(), 0.1 * sampled.norm()) << told << "\n\n" << sampled;
    // Also along the best determined axis, which the norm hardly sees.
    const auto axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sampled).eigenvectors();
    const Eigen::Vector3d best = axes.col(0);
    const double ratio = best.dot(told * best) / best.dot(sampled * best);
    EXPECT_NEAR(ratio, 1.0, 0.1);
  }
}

// The derivative of the pixel by the position, in steps.
Eigen::Matrix<double, 2, 3> SteppedJacobian(const KeyFrame& frame, const Eigen::Vector3d& point) {
  constexpr double kStep = 1e-5;
  Eigen::Matrix<double, 2, 3> jacobian;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    jacobian.col(i) = (*frame.camera.Project(frame.camera_from_map * (point + step)) -
                       *frame.camera.Project(frame.camera_from_map * (point - step))) /
                      (2 * kStep);
  }
  return jacobian;
}

// Seen 80 to 100 degrees off the axis.
TEST(CovarianceFromFramesTest, HoldsAtTheRimOfAFisheye) {
  std::vector<KeyFrame> frames = {testing::MakeFrame(0, {-2, -8, 1}),
                                  testing::MakeFrame(1, {0.5, -9, 2}),
                                  testing::MakeFrame(2, {1.5, -7, 0})};
  const Eigen::Quaterniond aside(Eigen::AngleAxisd(1.57, Eigen::Vector3d::UnitY()));
  const Eigen::Vector3d point(0.5, 0, 1);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (KeyFrame& frame : frames) {
    frame.camera = testing::FisheyeOf(220, 500);
    frame.camera_from_map = Rigid3{aside, {0, 0, 0}} * frame.camera_from_map;
    const auto jacobian = SteppedJacobian(frame, point);
    information += jacobian.transpose() * jacobian;
  }
  const std::vector<std::int32_t> seen_by = {0, 1, 2};
  const Eigen::Matrix3d told = Unpack(CovarianceFromFrames(point, frames, seen_by));
  const Eigen::Matrix3d expected = information.inverse();
  EXPECT_LT((told - expected).norm(), 1e-3 * expected.norm()) << told << "\n\n" << expected;
}

TEST(CovarianceFromFramesTest, ADirectionWithoutEvidenceGetsTheDistance) {
  const std::vector<KeyFrame> frames = {testing::MakeFrame(0, {0, -8, 1}),
                                        testing::MakeFrame(1, {0, -6, 1})};
  const std::vector<std::int32_t> both = {0, 1};  // on one ray
  const Eigen::Matrix3d told = Unpack(CovarianceFromFrames({0, 2, 1}, frames, both));
  EXPECT_NEAR(told(1, 1), 100.0, 1e-3);
  const double across = 1.0 / (800.0 * 800.0 * (1.0 / 100.0 + 1.0 / 64.0));
  EXPECT_NEAR(told(0, 0), across, 1e-3 * across);
  EXPECT_NEAR(told(2, 2), across, 1e-3 * across);
}

TEST(CovarianceFromFramesTest, WhatNoFrameHasInFrontIsNotKnown) {
  const std::vector<KeyFrame> frames = {testing::MakeFrame(0, {0, -8, 1})};
  const std::vector<std::int32_t> one = {0};
  EXPECT_EQ(CovarianceFromFrames({0, -9, 1}, frames, one), PositionCovariance{});
  EXPECT_EQ(CovarianceFromFrames({0, -8, 1}, frames, one), PositionCovariance{});
  EXPECT_EQ(CovarianceFromFrames({0, 0, 1}, frames, {}), PositionCovariance{});
  EXPECT_EQ(CovarianceFromFrames({0, 1e30, 1}, frames, one), PositionCovariance{});
}

TEST(ViewingFromFramesTest, TakesTheFramesThatSawIt) {
  const std::vector<KeyFrame> frames = {testing::MakeFrame(0, {0, -8, 1}),
                                        testing::MakeFrame(1, {5, -8, 1}),
                                        testing::MakeFrame(2, {0, -6, 1})};
  const std::vector<std::int32_t> seen_by = {0, 2};
  const ViewingRange range = ViewingFromFrames({0, 0, 1}, frames, seen_by);
  EXPECT_LT((range.toward_cameras_in_map - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6f);
  EXPECT_NEAR(range.max_angle_rad, 0, 1e-6);
  EXPECT_FLOAT_EQ(range.min_distance, 6.0f);
  EXPECT_FLOAT_EQ(range.max_distance, 8.0f);
}

}  // namespace
}  // namespace maploc
