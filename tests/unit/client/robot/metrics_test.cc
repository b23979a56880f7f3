#include "client/robot/metrics.h"

#include <cmath>

#include <gtest/gtest.h>

namespace maploc {
namespace {

using Errors = std::vector<std::optional<PoseError>>;

TEST(MetricsTest, RotationThresholdPassesThroughThePairsAndIsFlatOutside) {
  EXPECT_DOUBLE_EQ(RotationThresholdDeg(0.01), 2.0);
  EXPECT_DOUBLE_EQ(RotationThresholdDeg(0.25), 2.0);
  EXPECT_DOUBLE_EQ(RotationThresholdDeg(0.5), 5.0);
  EXPECT_DOUBLE_EQ(RotationThresholdDeg(1.0), 8.0);
  EXPECT_DOUBLE_EQ(RotationThresholdDeg(5.0), 10.0);
  EXPECT_DOUBLE_EQ(RotationThresholdDeg(50.0), 10.0);
}

TEST(MetricsTest, RotationThresholdIsLinearInTheLogarithmBetweenThePairs) {
  EXPECT_NEAR(RotationThresholdDeg(std::sqrt(0.25 * 0.5)), 3.5, 1e-12);
  EXPECT_NEAR(RotationThresholdDeg(std::sqrt(1.0 * 5.0)), 9.0, 1e-12);
}

TEST(MetricsTest, CurveOfPerfectAnswersIsOneAndOfNoneIsZero) {
  EXPECT_DOUBLE_EQ(AreaUnderCurve(Errors{PoseError{0.0, 0.0}, PoseError{0.0, 0.0}}), 1.0);
  EXPECT_DOUBLE_EQ(AreaUnderCurve(Errors{std::nullopt}), 0.0);
  EXPECT_DOUBLE_EQ(AreaUnderCurve(Errors{}), 0.0);
}

TEST(MetricsTest, UnansweredQueriesCountAsFailed) {
  EXPECT_DOUBLE_EQ(AreaUnderCurve(Errors{PoseError{0.0, 0.0}, std::nullopt}), 0.5);
  EXPECT_DOUBLE_EQ(Summarize(Errors{PoseError{0.0, 0.0}, std::nullopt}).recall[0], 0.5);
}

// 0.5 m is the middle of the geometric range 0.05 to 5 m: thresholds 50 to 99 of 0 to 99 pass.
TEST(MetricsTest, CurveIsGeometricInTranslation) {
  EXPECT_DOUBLE_EQ(AreaUnderCurve(Errors{PoseError{0.5, 0.0}}), 0.5);
}

// A turn of 9 degrees is forgiven above sqrt(1 * 5) m alone.
TEST(MetricsTest, CurveTightensRotationWithTranslation) {
  const double first = 99.0 * std::log(std::sqrt(5.0) / 0.05) / std::log(100.0);
  EXPECT_DOUBLE_EQ(AreaUnderCurve(Errors{PoseError{0.0, 9.0}}), (99.0 - std::floor(first)) / 100.0);
}

TEST(MetricsTest, WrongMeansLocalizedAndFarOffInEitherRespect) {
  const Metrics metrics = Summarize(
      Errors{PoseError{1.1, 0.0}, PoseError{0.0, 10.1}, PoseError{1.0, 10.0}, std::nullopt});
  EXPECT_EQ(metrics.queries, 4);
  EXPECT_EQ(metrics.localized, 3);
  EXPECT_EQ(metrics.wrong, 2);
}

TEST(MetricsTest, MediansAreOverLocalizedQueriesAndAbsentWithoutThem) {
  const Metrics metrics =
      Summarize(Errors{PoseError{0.1, 3.0}, std::nullopt, PoseError{0.3, 1.0}, std::nullopt});
  EXPECT_DOUBLE_EQ(*metrics.median_translation_error_m, 0.2);
  EXPECT_DOUBLE_EQ(*metrics.median_rotation_error_deg, 2.0);
  EXPECT_FALSE(Summarize(Errors{std::nullopt}).median_translation_error_m.has_value());
}

TEST(MetricsTest, RecallNeedsBothThresholds) {
  const Metrics metrics = Summarize(
      Errors{PoseError{0.2, 1.0}, PoseError{0.2, 6.0}, PoseError{0.9, 1.0}, PoseError{6.0, 1.0}});
  EXPECT_DOUBLE_EQ(metrics.recall[0], 0.25);
  EXPECT_DOUBLE_EQ(metrics.recall[1], 0.25);
  EXPECT_DOUBLE_EQ(metrics.recall[2], 0.75);
  EXPECT_DOUBLE_EQ(metrics.recall[3], 0.75);
}

TEST(MetricsTest, QuantileInterpolates) {
  EXPECT_DOUBLE_EQ(*Quantile({3.0, 1.0, 2.0, 4.0}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(*Quantile({1.0, 2.0}, 1.0), 2.0);
  EXPECT_FALSE(Quantile({}, 0.5).has_value());
}

TEST(MetricsTest, ErrorIsBetweenBodiesInTheMap) {
  Rigid3 reference;
  reference.translation = {1, 2, 3};
  Rigid3 estimate = reference;
  estimate.translation.x() += 0.3;
  estimate.rotation = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ());
  const PoseError error = ErrorBetween(estimate, reference);
  EXPECT_NEAR(error.translation_m, 0.3, 1e-12);
  EXPECT_NEAR(error.rotation_deg, 0.1 * 180.0 / 3.141592653589793, 1e-9);
}

TEST(MetricsTest, TheExpectedErrorIsOfAllAxes) {
  PoseCovariance covariance = PoseCovariance::Ones();  // no correlation counts
  covariance.diagonal() << 0.01, 0.04, 0.04, 1e-4, 4e-4, 4e-4;
  const PoseError expected = ExpectedError(covariance);
  EXPECT_NEAR(expected.translation_m, 0.3, 1e-12);
  EXPECT_NEAR(expected.rotation_deg, 0.03 * 180.0 / 3.141592653589793, 1e-9);
}

}  // namespace
}  // namespace maploc
