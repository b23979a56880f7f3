// Do the matches contradict the calibration that was sent, and what does a usual error of it cost?
//
// A wrong focal length, principal point or undeclared distortion moves the pose and leaves little
// behind in the residuals: the pose bends to fit. So the lens is estimated beside the pose
// (lens_fit.h), first the focal length alone and then all of it, and compared with the sent one.
#pragma once

#include <optional>

#include "mapstore/model/localization.h"
#include "server/refinement/refine.h"

namespace maploc {

struct CalibrationCheck {
  // False where another lens is beyond doubt: it is kMaxDistance2 away, and with it the pose
  // explains kClearGain more of the matches. The second is asked because with a thousand matches
  // the map's own bends look like a lens at a dozen sigmas. Or where the focal length is further
  // off than such bends make it look.
  bool consistent = true;
  // The focal length that was found, all else as it was sent, over the sent one; unset where the
  // matches do not determine it to a tenth.
  std::optional<FocalScale> focal_scale;
  // What the lens adds to the pose's covariance (of map_from_camera, as RefinedPose has it): little
  // where the matches determine it, much on a wall that is seen head-on, where a longer focal
  // length is a larger distance; and as far as the matches speak of another lens, short of
  // certainty, by that lens.
  PoseCovariance covariance = PoseCovariance::Zero();
};

// Gravity, where `problem` has it, is believed. Wide cameras (features with frames) are not
// doubted, and cost nothing: their lens is another one. O(inliers); deterministic; thread-safe.
CalibrationCheck CheckCalibration(const PoseProblem& problem, const RefinedPose& pose,
                                  double max_reprojection_error_px);

}  // namespace maploc
