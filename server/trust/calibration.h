// Do the matches contradict the calibration that was sent, and how much uncertainty does a usual
// calibration error add to the pose?
//
// A wrong focal length, principal point or undeclared distortion moves the pose but changes the
// residuals little, because the pose adapts. The lens is therefore estimated together with the pose
// (lens_fit.h), first the focal length alone and then all of it, and compared with the sent one.
#pragma once

#include <optional>

#include "mapstore/model/localization.h"
#include "server/refinement/refine.h"

namespace maploc {

struct CalibrationCheck {
  // False if another lens is certain. Either that lens is kMaxDistance2 away, and with it the pose
  // explains kClearGain more of the matches (the gain is required because with a thousand matches
  // the map's own distortions look like a lens error of a dozen sigmas). Or the focal length is
  // further off than such distortions explain.
  bool consistent = true;
  // The focal length found (all else as sent) divided by the sent one; unset where the matches do
  // not determine it to a tenth.
  std::optional<FocalScale> focal_scale;
  // What the lens adds to the pose's covariance (of map_from_camera, as in RefinedPose). It is
  // small where the matches determine the lens. It is large on a wall that is seen head-on, where a
  // longer focal length looks like a larger distance. If the matches suggest another lens, without
  // certainty, the effect of that lens is added.
  PoseCovariance covariance = PoseCovariance::Zero();
};

// Gravity, where `problem` has it, is taken as correct. Wide cameras (features with frames) have
// another lens model: they are always consistent, at no cost. O(inliers); deterministic;
// thread-safe.
CalibrationCheck CheckCalibration(const PoseProblem& problem, const RefinedPose& pose,
                                  double max_reprojection_error_px);

}  // namespace maploc
