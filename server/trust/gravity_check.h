// Does the measured gravity contradict the matches?
//
// A pose refined WITH gravity as a measurement was pulled towards it: its own disagreement is too
// small by what it gave way, and its covariance holds gravity's sigma already, so that the two may
// not be compared. Compared is what is independent: gravity as it was measured (sigma^2 I) and
// gravity as a pose refined from the matches alone has it (P, the tilt block of that pose's
// covariance). Their difference v, a turn about the map's two horizontal axes, has the covariance
// S = sigma^2 I + P where both are sound: the innovation of a Kalman filter that is given gravity
// last. v^T S^-1 v is chi-square of 2 degrees of freedom; beyond p = 1e-4 gravity contradicts.
#pragma once

#include "server/refinement/refine.h"

namespace maploc {

struct GravityCheck {
  double disagreement_rad = 0.0;                       // |v|
  Eigen::Vector2d tilt_rad = Eigen::Vector2d::Zero();  // v
  bool consistent = true;
};

// Refines `pose` without gravity, by inliers gathered anew, and compares. Where the matches alone
// do not hold a pose, or nothing was measured, gravity is consistent. Looks at some 200
// inliers. Deterministic; thread-safe.
GravityCheck CheckGravity(const PoseProblem& problem, const RefinedPose& pose,
                          const RefineOptions& options);

// The comparison itself. `matches_alone` refined without gravity; of `problem` its gravity counts.
// A sigma below 0.1 degrees counts as 0.1: no accelerometer and no mount is more exact.
GravityCheck CompareGravity(const PoseProblem& problem, const RefinedPose& matches_alone);

}  // namespace maploc
