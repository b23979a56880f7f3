#include "client/odometry/track.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace maploc {
namespace {

// Frames that are nearer to each other show the same, and err alike.
constexpr double kPlaceMeters = 0.05;
constexpr double kPlaceRadians = 0.05;

// The largest contradiction over all directions of three dimensions, in standard deviations.
double Sigmas(const Eigen::Vector3d& gap, const Eigen::Matrix3d& covariance) {
  const double squared = gap.dot(covariance.llt().solve(gap));
  // Rounding may leave no covariance where an answer's variances are 10^12 times odometry's.
  return squared >= 0.0 ? std::sqrt(squared) : std::numeric_limits<double>::infinity();
}

// A Kalman filter's update.
UncertainPose Fused(const UncertainPose& expected, const UncertainPose& measured) {
  const PoseCovariance sum = expected.covariance + measured.covariance;
  // P S^-1 as (S^-1 P)^T, because both are symmetric: S is solved with and never inverted.
  const PoseCovariance gain = sum.llt().solve(expected.covariance).transpose();
  const PoseCovariance rest = PoseCovariance::Identity() - gain;
  // Joseph's form of the update stays symmetric and positive whatever the rounding.
  return {Plus(expected.map_from_body,
               gain * Difference(measured.map_from_body, expected.map_from_body)),
          rest * expected.covariance * rest.transpose() +
              gain * measured.covariance * gain.transpose()};
}

}  // namespace

Track::Track(const OdometryDrift& drift, const Rigid3& odom_from_base, const UncertainPose& answer)
    : drift_(drift) {
  Take(odom_from_base, answer, false);
}

PoseCovariance Track::Measured(const UncertainPose& answer) const {
  return answer.covariance + AtRestCovariance(drift_);
}

Way Track::WayTo(const Rigid3& odom_from_base) const {
  const Rigid3 step = last_odom_from_base_.Inverse() * odom_from_base;
  return {
      way_.meters + step.translation.norm(),
      way_.radians + RotationAngleBetween(last_odom_from_base_.rotation, odom_from_base.rotation)};
}

void Track::Advance(const Rigid3& odom_from_base) {
  way_ = WayTo(odom_from_base);
  last_odom_from_base_ = odom_from_base;
}

UncertainPose Track::MapFromBase(const Rigid3& odom_from_base) const {
  UncertainPose pose = Moved(map_from_base_, odom_from_base_.Inverse() * odom_from_base);
  // By the way driven and not by the distance: odometry drifts in a circle too.
  pose.covariance +=
      DriftCovariance(drift_, WayTo(odom_from_base),
                      pose.map_from_body.translation - map_from_base_.map_from_body.translation);
  return pose;
}

UncertainPose Track::MapFromOdom() const {
  return maploc::MapFromOdom(map_from_base_, odom_from_base_);
}

Gap Track::GapTo(const Rigid3& odom_from_base, const UncertainPose& answer) const {
  const UncertainPose expected = MapFromBase(odom_from_base);
  const PoseVector gap = Difference(answer.map_from_body, expected.map_from_body);
  const PoseCovariance covariance = expected.covariance + Measured(answer);
  // Position and rotation apart, so that the verdict can name the one that contradicts.
  return {gap.head<3>().norm(), gap.tail<3>().norm(),
          Sigmas(gap.head<3>(), covariance.topLeftCorner<3, 3>()),
          Sigmas(gap.tail<3>(), covariance.bottomRightCorner<3, 3>())};
}

bool Track::IsAtThisPlace(const Rigid3& odom_from_base) const {
  return (odom_from_base.translation - odom_from_base_.translation).norm() < kPlaceMeters &&
         RotationAngleBetween(odom_from_base_.rotation, odom_from_base.rotation) < kPlaceRadians;
}

void Track::Average(const Rigid3& odom_from_base, const UncertainPose& measured) {
  const UncertainPose here = Moved(measured, odom_from_base.Inverse() * odom_from_base_);
  const double share = 1.0 / ++answers_;
  mean_.map_from_body =
      Plus(mean_.map_from_body, share * Difference(here.map_from_body, mean_.map_from_body));
  // However their errors depend on each other, that of the mean is no larger.
  mean_.covariance += share * (here.covariance - mean_.covariance);
}

void Track::Take(const Rigid3& odom_from_base, const UncertainPose& answer, bool smooth) {
  const UncertainPose measured{answer.map_from_body, Measured(answer)};
  if (smooth && IsAtThisPlace(odom_from_base)) {
    Average(odom_from_base, measured);
  } else {
    before_ = smooth ? std::optional(MapFromBase(odom_from_base)) : std::nullopt;
    odom_from_base_ = odom_from_base;
    mean_ = measured;
    answers_ = 1;
  }
  map_from_base_ = before_ ? Fused(*before_, mean_) : mean_;
  last_odom_from_base_ = odom_from_base;
  way_ = {};
}

}  // namespace maploc
