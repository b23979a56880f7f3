// One belief of where the robot is: an answer, and what odometry and further answers made of it.
#pragma once

#include <optional>

#include "client/odometry/decision.h"
#include "client/odometry/drift.h"

namespace maploc {

class Track {
 public:
  // The answer's covariance must be positive definite with the drift at rest added.
  Track(const OdometryDrift& drift, const Rigid3& odom_from_base, const UncertainPose& answer);

  // The robot came to here.
  void Advance(const Rigid3& odom_from_base);
  // The pose there, with what odometry may have added since the last answer.
  UncertainPose MapFromBase(const Rigid3& odom_from_base) const;
  UncertainPose MapFromOdom() const;
  Gap GapTo(const Rigid3& odom_from_base, const UncertainPose& answer) const;
  // Follows the answer: wholly, or smoothed with what was known before (a Kalman filter's update).
  // Smoothed answers of one place count as one, because they err alike.
  void Take(const Rigid3& odom_from_base, const UncertainPose& answer, bool smooth);

 private:
  Way WayTo(const Rigid3& odom_from_base) const;
  // As measured where the robot's odometry was read.
  PoseCovariance Measured(const UncertainPose& answer) const;
  bool IsAtThisPlace(const Rigid3& odom_from_base) const;
  // Adds an answer of this place to the mean.
  void Average(const Rigid3& odom_from_base, const UncertainPose& measured);

  OdometryDrift drift_;
  // A place is where the last answers were taken; it begins with the first of them.
  Rigid3 odom_from_base_;                // at its begin
  std::optional<UncertainPose> before_;  // the belief there without its answers; none: it had none
  UncertainPose mean_;                   // of its answers
  int answers_ = 0;                      // so many
  UncertainPose map_from_base_;          // there, of all this
  Rigid3 last_odom_from_base_;           // where the way ends
  Way way_;                              // since the last answer that was taken
};

}  // namespace maploc
