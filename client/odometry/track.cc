#include "client/odometry/track.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace maploc {
namespace {

// The largest contradiction over all directions of three dimensions, in standard deviations.
double Sigmas(const Eigen::Vector3d& gap, const Eigen::Matrix3d& covariance) {
  return std::sqrt(gap.dot(covariance.llt().solve(gap)));
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

void Track::Take(const Rigid3& odom_from_base, const UncertainPose& answer, bool smooth) {
  const PoseCovariance measured = Measured(answer);
  if (smooth) {
    const UncertainPose expected = MapFromBase(odom_from_base);
    const PoseCovariance sum = expected.covariance + measured;
    // P S^-1 as (S^-1 P)^T, because both are symmetric: S is solved with and never inverted.
    const PoseCovariance gain = sum.llt().solve(expected.covariance).transpose();
    const PoseCovariance rest = PoseCovariance::Identity() - gain;
    // Joseph's form of the update stays symmetric and positive whatever the rounding.
    map_from_base_ = {
        Plus(expected.map_from_body,
             gain * Difference(answer.map_from_body, expected.map_from_body)),
        rest * expected.covariance * rest.transpose() + gain * measured * gain.transpose()};
  } else {
    map_from_base_ = {answer.map_from_body, measured};
  }
  odom_from_base_ = last_odom_from_base_ = odom_from_base;
  way_ = {};
}

}  // namespace maploc
