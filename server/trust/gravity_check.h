// Does the measured gravity contradict the matches?
//
// A pose refined WITH gravity as a measurement is biased towards the measurement: its disagreement
// with gravity is too small, and its covariance includes gravity's sigma already. The two may not
// be compared. Two independent values are compared instead: gravity as it was measured (covariance
// sigma^2 I), and gravity according to a pose refined from the matches alone (covariance P, the
// tilt block of that pose's covariance). Their difference v, a rotation about the map's two
// horizontal axes, has the covariance S = sigma^2 I + P where both are sound: the innovation of a
// Kalman filter that gets gravity last. v^T S^-1 v is chi-square with 2 degrees of freedom. Gravity
// contradicts the matches beyond p = 1e-4.
#pragma once

#include "server/refinement/refine.h"

namespace maploc {

struct GravityCheck {
  double disagreement_rad = 0.0;                       // |v|
  Eigen::Vector2d tilt_rad = Eigen::Vector2d::Zero();  // v
  bool consistent = true;
};

// Refines `pose` without gravity, with inliers gathered again, and compares. Gravity is consistent
// where the matches alone do not determine a pose, or where nothing was measured. Uses about 200
// inliers. Deterministic; thread-safe.
GravityCheck CheckGravity(const PoseProblem& problem, const RefinedPose& pose,
                          const RefineOptions& options);

// The comparison itself. `matches_alone` was refined without gravity; only the gravity of `problem`
// is used. A sigma below 0.1 degrees counts as 0.1: no accelerometer and no mount is more exact.
GravityCheck CompareGravity(const PoseProblem& problem, const RefinedPose& matches_alone);

}  // namespace maploc
