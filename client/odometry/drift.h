// How far odometry may be wrong: stated by the user, as standard deviations.
#pragma once

#include "client/odometry/uncertain_pose.h"

namespace maploc {

// In the map's axes, z up.
struct PoseSigmas {
  double horizontal_m = 0.0;  // of x, and of y
  double vertical_m = 0.0;    // of z
  double tilt_rad = 0.0;      // about x, and about y
  double yaw_rad = 0.0;       // about z
};

// The defaults suit wheels whose odometry knows no slopes: README.md says when to change them.
struct OdometryDrift {
  PoseSigmas at_rest{0.01, 0.01, 0.01, 0.005};    // stamps that do not fit, springs: no drift
  PoseSigmas per_meter{0.02, 0.05, 0.02, 0.01};   // of the way driven
  PoseSigmas per_radian{0.02, 0.01, 0.01, 0.03};  // of the angle turned
};

// How far a robot went, over whatever curves.
struct Way {
  double meters = 0.0;
  double radians = 0.0;
};

// INVALID_ARGUMENT with the field's name: a sigma that is negative or not finite, or one at rest
// that is zero.
Status CheckDrift(const OdometryDrift& drift);

// Of what odometry adds over a way that led by `travel_in_map` (end minus start). The variance is
// sigma^2 * way * max(way, 1): so a metre with ten answers is as uncertain as one with two, and a
// long way without any is wrong by a share of it, because a wheel's wrong radius does not average
// out. A drift of rotation counts as if it came half way.
PoseCovariance DriftCovariance(const OdometryDrift& drift, const Way& way,
                               const Eigen::Vector3d& travel_in_map);

// Of what is wrong between an answer and the odometry at its stamp, wherever the robot is.
PoseCovariance AtRestCovariance(const OdometryDrift& drift);

}  // namespace maploc
