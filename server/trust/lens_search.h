// Would clearly more matches agree if another lens had taken the picture?
//
// A lens far from the sent one leaves a biased sample: those matches that agree with the sent lens
// from some wrong pose. A fit that starts from them (lens_fit.h) stays there. So the pose is
// searched anew through a few other lenses: focal lengths from half to double the sent one, and
// principal points that are off. The other lens applies before the distortion: keypoints move in
// the image and are undistorted anew. (Of a lens that distorts, another focal length is no change
// of scale in the undistorted plane.)
#pragma once

#include "mapstore/geometry/camera.h"
#include "mapstore/model/matches.h"
#include "server/refinement/refine.h"

namespace maploc {

// `problem` has gravity if it was sent and the matches agree with it. `gravity_rejected`: it was
// sent, and they contradict it; then a lens must explain the gravity, too. (A principal point that
// is off turns the pose.) Without such a contradiction the search is for poses that leave more than
// half of the points unexplained; others cost nothing. Points alone count, because lines are few
// where many points are wrong. False for wide cameras. Deterministic; thread-safe.
bool AgreesBetterThroughAnotherLens(const PoseProblem& problem, const RefinedPose& pose,
                                    const Camera& camera, bool gravity_rejected,
                                    double max_reprojection_error_px);

}  // namespace maploc
